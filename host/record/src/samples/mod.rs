//! `run.mcap`: every sample, with the bits that it had in the run.
//!
//! | topic | message | log time | publish time |
//! |---|---|---|---|
//! | `/step` | truth, torque, counts and reference as sent, timing; one per control step | time of the step | the same |
//! | `/drive` | the subscribed signals; one per telemetry | time of the sample that they belong to | time of the step that it came in |
//! | `/fault` | kind and number of an injected fault, begin or end; a message for each | time of the step | time of the step that is written next |
//! | `/log` | a text of the drive or about it | time of the step of its arrival | as of `/fault` |
//!
//! Times are in ns since 1970: the start of the run by the wall clock, and the time of the run. A telemetry has the time of its
//! sample; its sequence number is the step that it arrived in. The sequence number of `/step` is 0: its time has the step, and
//! an equal number takes no bytes. Chunks are compressed by LZ4 and written whole, each with the index of its messages; the
//! index of the chunks is written at the end.
//!
//! In records of format 2 times start at 0 and messages are packed as by ROS 1.

mod columns;
mod container;
mod copy;
mod encoder;
mod events;
mod layout;
mod packing;
mod reader;
mod step_times;
mod table;
mod writer;

pub use container::ContainerError;
pub use copy::copy_with_index;
pub use encoder::{Encoder, Place, Topic};
pub use events::{RecordedEdge, RecordedText};
pub use packing::{MESSAGE_ENCODING, SCHEMA_ENCODING};
pub use reader::{Samples, SamplesError};
pub use step_times::StepTimes;
pub use table::write_table;
pub use writer::SampleWriter;
