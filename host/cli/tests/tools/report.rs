//! `lashloop run --report` when its page can't be written.

use std::fs;
use std::process::Command;

use crate::support::{LASHLOOP, root, text};

/// Blocks of 512 bytes: more than a file of a short record, less than a page.
const LARGEST_FILE: &str = "80";

#[test]
fn a_run_without_its_page_has_its_verdict_and_is_no_success() {
    for (expectations, code) in [("expect=[]", 2), (NEVER_MET, 1)] {
        run_without_room_for_its_page(expectations, code);
    }
}

/// The first torque is larger.
const NEVER_MET: &str = "expect=[{ metric = 'peak_torque_nm', unit = 'N m', max = 0.001 }]";

fn run_without_room_for_its_page(expectations: &str, code: i32) {
    let folder = tempfile::tempdir().unwrap();
    let mut run = Command::new("sh");
    run.args(["-c", "trap '' XFSZ; ulimit -f $0; exec \"$@\"", LARGEST_FILE, LASHLOOP, "run"]);
    run.arg(root().join("scenarios/smooth-after.toml")).current_dir(folder.path());
    run.args(["--device", "inproc", "--out", "out", "--report", "--junit", "result.xml"]);
    let ended = run.args(["--set", "run.duration_s=0.01", "--set", expectations]).output().unwrap();
    let (printed, warned) = (text(&ended.stdout), text(&ended.stderr));
    assert_eq!(ended.status.code(), Some(code), "{warned}");
    assert!(printed.starts_with(if code == 1 { "FAIL  " } else { "PASS, nothing expected  " }), "{printed}");
    assert!(warned.contains("out/report.html: can't be written"), "{warned}");
    let junit = fs::read_to_string(folder.path().join("result.xml")).unwrap();
    assert!(junit.contains("errors=\"0\"") && !junit.contains("<error"), "{junit}");
    assert!(folder.path().join("out/summary.json").exists());
}
