//! `lashloop export` replaces no samples, and no file by a part of another.

use std::fs;
use std::process::Command;

use crate::diff::Runs;
use crate::support::{LASHLOOP, lashloop, text};

#[test]
fn file_of_a_record_is_never_replaced() {
    let runs = Runs::new();
    let record = runs.run("a", &[]);
    let (folder, samples) = (record.to_str().unwrap(), record.join("run.mcap"));
    let before = fs::read(&samples).unwrap();
    let onto = ["export", folder, "--to", "mcap", "--out", samples.to_str().unwrap()];
    let figure = ["report", folder, "--out", samples.to_str().unwrap()];
    for arguments in [&onto[..], &figure] {
        let ended = lashloop(arguments, &[]);
        let refused = text(&ended.stderr).contains("part of a record");
        assert!(ended.status.code() == Some(2) && refused, "{}", text(&ended.stderr));
    }
    assert!(before == fs::read(&samples).unwrap());
    assert_eq!(lashloop(&["export", folder, "--to", "mcap"], &[]).status.code(), Some(0));
}

#[test]
fn full_disk_leaves_the_older_export() {
    let runs = Runs::new();
    let record = runs.run("a", &[]);
    fs::write(record.join("export.csv"), "older\n").unwrap();
    let files = || fs::read_dir(&record).unwrap().count();
    let before = files();
    // With SIGXFSZ ignored, a write beyond the limit fails as on a full disk.
    let script = "trap '' XFSZ; ulimit -f 8; exec \"$0\" \"$@\"";
    let mut command = Command::new("sh");
    command.args(["-c", script, LASHLOOP, "export"]).arg(&record).args(["--to", "csv"]);
    let ended = command.output().unwrap();
    assert_eq!(ended.status.code(), Some(2), "{}", text(&ended.stderr));
    assert!(text(&ended.stderr).contains("export.csv: can't be written"), "{}", text(&ended.stderr));
    assert_eq!(fs::read_to_string(record.join("export.csv")).unwrap(), "older\n");
    assert_eq!(files(), before, "a part is left");
}

#[test]
fn run_with_csv_has_the_same_table_at_once() {
    let runs = Runs::new();
    let record = runs.run("a", &["--csv"]);
    let at_once = fs::read(record.join("export.csv")).unwrap();
    assert_eq!(lashloop(&["export", record.to_str().unwrap(), "--to", "csv"], &[]).status.code(), Some(0));
    assert!(at_once == fs::read(record.join("export.csv")).unwrap());
    assert_eq!(text(&at_once).lines().count(), 201, "a header and a row for each step");
    assert!(!runs.run("b", &[]).join("export.csv").exists());
}
