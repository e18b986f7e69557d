//! The record of a run.
//!
//! | file | content | module |
//! |---|---|---|
//! | `trace.csv` | the plant's true state and the torque, one row per control step | [`trace`] |
//! | `timing.csv` | timing of each control step | [`timing`] |
//! | `summary.json` | the verdict and all that is needed to check and repeat it | [`summary`] |
//!
//! [`reader`] reads them back. Rows are written whole, and a summary takes its name only when it is complete, so that an
//! interrupted run leaves neither half a row nor half a summary.

pub mod digest;
pub mod reader;
pub mod row;
pub mod summary;
pub mod table;
pub mod timing;
pub mod trace;
