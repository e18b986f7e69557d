//! `lashloop run --report` when its page can't be written.

use std::fs;
use std::process::Command;

use crate::support::{LASHLOOP, root, text};

/// Blocks of 512 bytes: more than a file of a short record, less than a page.
const LARGEST_FILE: &str = "80";

#[test]
fn verdict_of_a_run_does_not_depend_on_its_page() {
    let folder = tempfile::tempdir().unwrap();
    let mut run = Command::new("sh");
    run.args(["-c", "trap '' XFSZ; ulimit -f $0; exec \"$@\"", LARGEST_FILE, LASHLOOP, "run"]);
    run.arg(root().join("scenarios/smooth-after.toml")).current_dir(folder.path());
    run.args(["--device", "inproc", "--out", "out", "--report", "--junit", "result.xml"]);
    let ended = run.args(["--set", "run.duration_s=0.01", "--set", "expect=[]"]).output().unwrap();
    let (printed, warned) = (text(&ended.stdout), text(&ended.stderr));
    assert_eq!(ended.status.code(), Some(0), "{warned}");
    assert!(printed.starts_with("PASS  "), "{printed}");
    assert!(warned.contains("warning: no page of the run: out/report.html: can't be written"), "{warned}");
    let junit = fs::read_to_string(folder.path().join("result.xml")).unwrap();
    assert!(junit.contains("errors=\"0\"") && !junit.contains("<error"), "{junit}");
    assert!(folder.path().join("out/summary.json").exists());
}
