//! The electrical side of a drive: a brushed motor on a bridge, its supply, and the sensor of its current.
//!
//! ```text
//! L di/dt   = v - R i - k_t w        armature; w is the motor's speed, and the torque is k_t i
//! v         = d V - v_dead(i)        a bridge with the duty d, -1 to 1, over a period of its modulation
//! C dV/dt   = (V_0 - V) / R_s - d i  supply: a source behind a resistance, and the capacitor of the bus
//! ```
//!
//! Voltages and currents are means over half a period of the modulation: a drive that samples the current in the middle of a pulse sees
//! the mean. [`Circuit`] is the physics alone. [`ElectricalPlant`] puts it between the torque that a drive commands and any plant;
//! what makes a duty of the torque is the drive's, a [`StageControl`].

mod circuit;
mod parameters;
mod plant;
mod sensor;

pub use circuit::{Bridge, Circuit};
pub use parameters::{ElectricalParameters, ReverseCurrent, keys};
pub use plant::{ElectricalPlant, REST_READINGS, StageControl, StageReading};
pub use sensor::CurrentSensor;
