//! Commissioning of a drive train by runs of the bench.
//!
//! The order of the motions, their torques and the estimates are those of `lashloop_identify::excitation`. Here each motion
//! becomes a run of the law `open-loop`, with a reference that is the torque, and the guard observes its steps.

mod drive_train;
mod scenario;

pub use drive_train::{MotionError, OnDevice, RecordError, RunRecord};
pub use scenario::settings;
