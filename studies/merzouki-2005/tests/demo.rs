//! The demo as a program of its own.

use std::fs;
use std::process::Command;

#[test]
fn the_demo_prints_a_row_for_each_run_and_draws_its_figure() {
    let folder = tempfile::tempdir().expect("a folder");
    let ended = Command::new(env!("CARGO_BIN_EXE_demo")).current_dir(&folder).output().expect("the demo");
    let printed = String::from_utf8_lossy(&ended.stdout);
    assert!(ended.status.success(), "{printed}{}", String::from_utf8_lossy(&ended.stderr));
    let passed = printed.lines().filter(|line| line.ends_with(" PASS")).count();
    assert_eq!((printed.lines().count(), passed), (6, 4), "{printed}");
    let svg = fs::read_to_string(folder.path().join("out/demo.svg")).expect("a figure");
    roxmltree::Document::parse(&svg).expect("well-formed XML");
}
