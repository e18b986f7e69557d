//! What a run leaves behind.
//!
//! | file | holds | in |
//! |---|---|---|
//! | `trace.csv` | one row per control step | [`trace`] |
//! | `timing.csv` | how each control step went in time | [`timing`] |
//! | `summary.json` | the verdict and everything needed to trust and repeat it | [`summary`] |
//!
//! [`reading`] reads them back. A reader never meets half a row or half a summary: rows reach the file whole, and a summary takes its name
//! only when it is complete.

pub mod digest;
pub mod reader;
pub mod row;
pub mod summary;
pub mod table;
pub mod timing;
pub mod trace;
