//! The mechanics behind the encoders: two masses, a spring and a gap.
//!
//! A plant knows nothing of links, time or files: a torque is held for a while, and the state moves on. What only a
//! plant can know, its [`Truth`], goes to the record and never to the drive.
//!
//! ```text
//! J_m dd(theta_e) + f_m d(theta_e) + C           = U         motor
//! J_s dd(theta_s) + f_s d(theta_s) + F(d theta_s) = N0 C     load
//! z = theta_e - N0 theta_s                                   twist
//! ```
//!
//! | profile | transmitted torque C | friction F of the load |
//! |---|---|---|
//! | [`smooth`] | K (z - 4 j0 tanh(z / 4 j0)), the paper's equations (1) and (5) | none |
//! | [`hard_coulomb`] | K (z -+ j0) in contact, nought in the gap | Coulomb, with sticking |
//! | [`backlash_shaft`] | K (z - theta_b) + c dz/dt in contact, theta_b moving in the gap | Stribeck or LuGre; Stribeck on the motor |
//!
//! [`integrator`] moves any of them: Runge-Kutta of fourth order at a fixed substep, with the instants at which contact
//! or sticking changes located on the substep. All functions are the `libm` crate's or our own, so a trajectory has the
//! same bits on every machine.

#![forbid(unsafe_code)]

mod any_plant;
pub mod backlash_shaft;
pub mod encoder;
mod error;
mod exponential;
pub mod hard_coulomb;
pub mod integrator;
mod mechanics;
pub mod metrics;
pub mod reference;
pub mod smooth;
mod transport_delay;
mod truth;

pub use any_plant::{AnyPlant, AnyPlantState};
pub use error::{ParameterError, PlantError};
pub use mechanics::{Mechanics, Start};
pub use transport_delay::TransportDelay;
pub use truth::{Contact, DryFriction, Truth};

/// A plant: parameters in the implementor, everything that moves in the state.
pub trait Plant {
    /// Coordinates and modes of the plant.
    type State: Clone;

    /// The state of a plant released at rest.
    fn initial_state(&self, start: Start) -> Self::State;

    /// Holds `torque_nm` at the motor for `dt_s` seconds.
    ///
    /// # Errors
    /// The input isn't finite, the state left the range of numbers, or contact or sticking changes without end.
    fn step(&self, state: &mut Self::State, torque_nm: f64, dt_s: f64) -> Result<(), PlantError>;

    /// Everything there is to know about a state.
    fn truth(&self, state: &Self::State) -> Truth;
}
