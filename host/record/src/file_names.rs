//! Names of the files in the folder of a record.

/// The manifest.
pub const MANIFEST_FILE: &str = "record.json";
/// The resolved scenario.
pub const SCENARIO_FILE: &str = "scenario.toml";
/// The points of a reference by table.
pub const REFERENCE_FILE: &str = "reference.csv";
/// Every sample.
pub const SAMPLES_FILE: &str = "run.mcap";
/// The trace.
pub const TRACE_FILE: &str = "trace.csv";
/// The columns of the trace.
pub const COLUMNS_FILE: &str = "trace.json";
/// The timing.
pub const TIMING_FILE: &str = "timing.csv";
/// The summary.
pub const SUMMARY_FILE: &str = "summary.json";
/// The page of `--report`.
pub const REPORT_FILE: &str = "report.html";
/// The link to the latest record, next to its folder.
pub const LATEST: &str = "latest";

/// Every file that a record may have, the manifest last: a folder without it holds no record of this format.
pub const ALL: [&str; 9] = [
    SUMMARY_FILE,
    REPORT_FILE,
    TIMING_FILE,
    TRACE_FILE,
    COLUMNS_FILE,
    SAMPLES_FILE,
    REFERENCE_FILE,
    SCENARIO_FILE,
    MANIFEST_FILE,
];
