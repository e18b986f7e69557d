//! `lashloop paper demo`: the first command of a new user.

use std::fs;

use tests::program;
use tests::records::Records;

#[test]
fn demo_prints_a_table_and_draws_one_figure() {
    for device in ["inproc", "native"] {
        let records = Records::new();
        let ended = program::run(["paper", "demo", "--device", device, "--out", &records.out()]).with_code(0);
        let (who, table) = ended.stdout.split_once('\n').expect("a line about the drive");
        assert!(who.starts_with(device), "{who}");
        // The same table for both devices, so one snapshot.
        insta::assert_snapshot!("table", table.replace(&records.out(), "OUT"));
        let svg = fs::read_to_string(records.path("demo.svg")).expect("a figure");
        let document = roxmltree::Document::parse(&svg).expect("well-formed XML");
        assert_eq!(document.root_element().tag_name().name(), "svg");
        let curves =
            document.descendants().filter(|node| matches!(node.tag_name().name(), "path" | "polyline"));
        assert!(curves.count() >= 6, "a curve for each run at least");
        let files = fs::read_dir(records.out()).expect("the folder").count();
        assert_eq!(files, 1, "one file");
    }
}
