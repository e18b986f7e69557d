//! The record of a run: everything that it leaves behind.
//!
//! | file | content | module |
//! |---|---|---|
//! | `trace.csv` | the plant's true state, the torque and the drive's signals, one row per control step | [`trace`] |
//! | `trace.json` | the columns of `trace.csv` with their units | [`trace`] |
//! | `timing.csv` | timing of each control step | [`timing`] |
//! | `summary.json` | the verdict and all that is needed to check and repeat it | [`summary`] |
//!
//! [`reader`] reads them back, and [`columns`] holds them in memory. Rows are written whole, and a summary takes its name
//! only when it is complete, so that an interrupted run leaves neither half a row nor half a summary.

#![forbid(unsafe_code)]
#![warn(missing_docs)]

pub mod columns;
mod file_names;
pub mod reader;
pub mod row;
pub mod summary;
pub mod table;
pub mod timing;
pub mod trace;
