//! The electrical side of a brushed motor on a bridge with a current sensor: R, L, k_e = k_t, and what is wrong with the sensor.
//!
//! The drive holds currents and reports the means of current and voltage over each of its periods. Between two instants a and b
//! the flux of the armature is balanced, whatever the current loop did meanwhile:
//!
//! ```text
//! sum of v T = R sum of i T + L (i_b - i_a) + k_e (theta_b - theta_a) + v_d sum of sgn(i) T + v_0 (t_b - t_a)
//! ```
//!
//! The instants are the ends of holds, where the current is flat and so known. v_d is what the dead time of the bridge takes, v_0
//! belongs to a remaining offset of the sensor. The motor may stand or turn: its encoder shows the angle between.

mod balance;
mod motions;
mod procedure;
mod stated;

pub use balance::{Motor, Steps};
pub use motions::HeldCurrents;
pub use procedure::{Checked, ElectricalError, ElectricalTrain, MadeSteps, StageTrip, commission_motor};
pub use stated::Stated;
