//! The demo as a program of its own.

use std::fs;
use std::process::Command;

use roxmltree::Document;

fn texts(svg: &str) -> Vec<String> {
    let document = Document::parse(svg).expect("well-formed XML");
    let texts = document.descendants().filter(|node| node.has_tag_name("text"));
    texts.filter_map(|text| text.text()).map(str::to_owned).collect()
}

#[test]
fn the_demo_prints_a_row_for_each_run_and_draws_its_figure() {
    let folder = tempfile::tempdir().expect("a folder");
    let ended = Command::new(env!("CARGO_BIN_EXE_demo")).current_dir(&folder).output().expect("the demo");
    let printed = String::from_utf8_lossy(&ended.stdout);
    assert!(ended.status.success(), "{printed}{}", String::from_utf8_lossy(&ended.stderr));
    let passed = printed.lines().filter(|line| line.ends_with(" PASS")).count();
    assert_eq!((printed.lines().count(), passed), (8, 6), "{printed}");
    let svg = fs::read_to_string(folder.path().join("out/demo.svg")).expect("a figure");
    for label in ["0.30 rad: load friction taken for gap", "0.16 rad \u{b1} 0.14 rad"] {
        assert!(svg.contains(label), "{label} is missing");
    }
    let shown = include_str!("../../../docs/demo.svg");
    assert_eq!(texts(shown), texts(&svg), "docs/demo.svg is not out/demo.svg of this demo");
}
