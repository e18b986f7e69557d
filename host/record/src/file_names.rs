//! Names of the files in the folder of a run.

/// The trace.
pub(crate) const TRACE_FILE: &str = "trace.csv";
/// The columns of the trace.
pub(crate) const COLUMNS_FILE: &str = "trace.json";
/// The timing.
pub(crate) const TIMING_FILE: &str = "timing.csv";
