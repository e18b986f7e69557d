//! `[[fault]]`: faults to inject during the run, nested by what they strike.
//!
//! | group | strikes | takes effect in |
//! |---|---|---|
//! | [`FrameFault`] | frames of one direction of the link, or of both | `fault/link/impairment.rs` |
//! | [`LinkFault`] | the connection itself | `fault/link/faulty_link.rs` |
//! | [`EncoderFault`] | counts between encoder and sample | `fault/encoder.rs` |
//! | [`MotorFault`] | torque between drive and plant | `fault/motor.rs` |
//! | [`PlantFault`] | gap, shaft and load | `fault/plant.rs` |
//! | [`DeviceFault`] | the drive | `fault/timeline.rs` |
//!
//! A new kind takes two places: its entry in the table of its group, which declares name, keys and ranges, and its effect,
//! which is matched exhaustively and doesn't compile before the kind is handled.

mod device;
mod encoder;
mod injected;
mod link;
mod motor;
mod plant;

pub use device::DeviceFault;
pub use encoder::{EncoderFault, Side};
pub use injected::{FaultDuration, FaultKind, InjectedFault};
pub use link::{FrameFault, LinkFault, Way};
pub use motor::MotorFault;
pub use plant::PlantFault;
