//! Drives with gear backlash: two masses, a spring and a gap.
//!
//! A [`Plant`] depends on no link, clock or file: it holds a torque for a time, and its state advances. Its signals are its
//! truth: the record contains them, the drive never receives them. A [`PlantModel`] builds a plant from the keys of a
//! scenario, and [`Plants`] has the models by name. The three of this crate share the [`Mechanics`] of two masses:
//!
//! ```text
//! J_m dd(theta_e) + f_m d(theta_e) + C           = U         motor
//! J_s dd(theta_s) + f_s d(theta_s) + F(d theta_s) = N0 C     load
//! z = theta_e - N0 theta_s                                   twist
//! ```
//!
//! | plant | transmitted torque C | friction F of the load |
//! |---|---|---|
//! | [`smooth`] | K (z - 4 j0 tanh(z / 4 j0)), the paper's equations (1) and (5) | none |
//! | [`hard_coulomb`] | K (z -+ j0) in contact, zero in the gap | Coulomb, with sticking |
//! | [`backlash_shaft`] | K (z - theta_b) + c dz/dt in contact, theta_b moving in the gap | Stribeck or LuGre; Stribeck on the motor |
//!
//! [`integrator`] advances all of them: Runge-Kutta of fourth order at a fixed substep, with located changes of contact
//! and sticking. All functions are the `libm` crate's or our own, so a trajectory has the same bits on every machine.

#![forbid(unsafe_code)]
#![warn(missing_docs)]

pub mod backlash_shaft;
mod coordinates;
pub mod electrical;
pub mod encoder;
mod error;
mod exponential_decay;
pub mod hard_coulomb;
pub mod integrator;
mod key;
pub mod limits;
mod mechanics;
pub mod metrics;
mod mode;
mod model;
mod numbers;
mod plant;
pub mod random;
pub mod reference;
mod registry;
mod saved_state;
mod signal;
pub mod smooth;
mod start;
mod transport_delay;
mod truth;
mod two_mass;
mod values;

pub use error::{ParameterError, PlantError};
pub use key::{Key, KeyKind, TORQUE_DELAY_US};
pub use mechanics::Mechanics;
pub use mode::{Contact, DryFriction, Flank};
pub use model::{Changes, PlantModel};
pub use plant::{Environment, Plant, Positions};
pub use registry::Plants;
pub use saved_state::{Numbers, SavedState};
pub use signal::{FIXED_COLUMNS, Signal};
pub use start::{Release, Start};
pub use transport_delay::TransportDelay;
pub use truth::Truth;
pub use two_mass::{RunningPlant, TwoMass};
pub use values::{PlantValue, PlantValues};
