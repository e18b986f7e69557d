//! Commissioning of a drive train by runs of the bench.
//!
//! The order of the motions, their torques and the estimates are those of `lashloop_identify::excitation`. Here each motion
//! becomes a run of the law `open-loop`, with a reference that is the torque, and the guard observes its steps. So do the motions of
//! `lashloop_identify::electrical`, for a motor at a bridge with a current sensor.

mod drive_train;
mod electrical;
mod scenario;
mod trip;

pub use drive_train::{MotionError, OnDevice, RecordError, RunRecord};
pub use electrical::{MotorOnDevice, stated};
pub use scenario::{pin_number, set_pin, settings};
