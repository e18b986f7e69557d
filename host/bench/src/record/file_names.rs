//! Names of the files in the folder of a run.

/// The trace.
pub(super) const TRACE_FILE: &str = "trace.csv";
/// The columns of the trace.
pub(super) const COLUMNS_FILE: &str = "trace.json";
/// The timing.
pub(super) const TIMING_FILE: &str = "timing.csv";
