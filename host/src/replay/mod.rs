//! The samples of a record, sent to another firmware without a plant, and the torques of both bit by bit.
//!
//! A torque depends on the samples since the start, the parameters in force and the code. Samples and parameters are those of
//! the record, so a torque that differs is a difference of the code.
//!
//! | module | has |
//! |---|---|
//! | `recording` | the samples as they were sent, and the torques that answered them |
//! | `parameters` | the parameters in force of the record, set on the device |
//! | `feed` | the samples sent, the answers compared |
//! | `report` | what differs |
//! | `error` | why a record can't be replayed |

mod error;
mod feed;
mod parameters;
mod recording;
mod report;

pub use error::ReplayError;
pub use feed::replay;
pub use recording::{RecordedStep, Recording};
pub use report::{DriveEnd, Replay, TorquePair};
