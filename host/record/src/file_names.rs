//! Names of the files in the folder of a record.

/// The manifest.
pub const MANIFEST_FILE: &str = "record.json";
/// The resolved scenario.
pub const SCENARIO_FILE: &str = "scenario.toml";
/// The points of a reference by table.
pub const REFERENCE_FILE: &str = "reference.csv";
/// Every sample.
pub const SAMPLES_FILE: &str = "run.mcap";
/// The summary.
pub const SUMMARY_FILE: &str = "summary.json";
/// What the drive has captured.
pub const SCOPE_FILE: &str = "scope.csv";
/// The error of a run without a summary.
pub const FAILURE_FILE: &str = "failure.json";
/// The page of `report`, or of `run --report`.
pub const REPORT_FILE: &str = "report.html";
/// The page of `report` for several records, in the folder of the first.
pub const COMPARISON_FILE: &str = "comparison.html";
/// The figure of `plot`.
pub const FIGURE_FILE: &str = "record.svg";
/// The files of `export`, one for each format. That of CSV is also the one of `run --csv`.
pub const EXPORT_FILES: [&str; 4] = ["export.csv", "export.parquet", "export.mcap", "export.mf4"];
/// The link to the latest record, next to its folder.
pub const LATEST: &str = "latest";

/// Every file that a run may write, in the order in which a new record gets them. The manifest is the last: from there on
/// the folder holds a record, whose beginning is whole.
pub const ALL: [&str; 7] =
    [SUMMARY_FILE, FAILURE_FILE, SCOPE_FILE, SAMPLES_FILE, REFERENCE_FILE, SCENARIO_FILE, MANIFEST_FILE];

/// What other commands derive from a record and write next to it, unless they are given another name.
pub const DERIVED: [&str; 7] = [
    REPORT_FILE,
    COMPARISON_FILE,
    FIGURE_FILE,
    EXPORT_FILES[0],
    EXPORT_FILES[1],
    EXPORT_FILES[2],
    EXPORT_FILES[3],
];
