//! `lashloop paper figures`: the figures, and the numbers that the documentation quotes.

use std::fs;

use rustix::process::Signal;
use tests::program::{self, Running};
use tests::records::Records;
use tests::wait;

const FIGURES: [u8; 12] = [5, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17];

/// The page that quotes the numbers.
fn results() -> String {
    fs::read_to_string(tests::workspace().join("docs/results.md")).expect("docs/results.md")
}

/// What stands between lines of ```` ```text ```` and ```` ``` ````, and everything else.
fn split(page: &str) -> (Vec<String>, String) {
    let (mut blocks, mut prose) = (Vec::new(), String::new());
    let mut parts = page.split("```");
    prose.push_str(parts.next().unwrap_or_default());
    while let (Some(block), Some(after)) = (parts.next(), parts.next()) {
        blocks.extend(block.strip_prefix("text\n").map(|text| text.trim_end().to_owned()));
        prose.push_str(after);
    }
    (blocks, prose)
}

/// Numbers with a decimal point.
fn decimals(text: &str) -> impl Iterator<Item = &str> {
    text.split(|letter: char| !(letter.is_ascii_digit() || letter == '.'))
        .map(|number| number.trim_matches('.'))
        .filter(|number| number.contains('.'))
}

#[test]
fn the_documented_numbers_are_those_the_command_prints() {
    let (tables, prose) = split(&results());
    assert_eq!(tables.len(), 3, "the tables of docs/results.md");
    for device in ["inproc", "native"] {
        let records = Records::new();
        let ended =
            program::run(["paper", "figures", "--device", device, "--out", &records.out()]).with_code(0);
        assert!(ended.stdout.starts_with(device), "{}", ended.stdout);
        assert_eq!(ended.stdout.matches(" PASS\n").count(), 12, "{}", ended.stdout);
        for table in &tables {
            assert!(
                ended.stdout.contains(table.as_str()),
                "docs/results.md has\n{table}\nand the command on {device} prints\n{}",
                ended.stdout
            );
        }
        // In the text around the tables: what a table has, or what is a parameter or a bound rather than a result.
        let known = "0.05 0.5 0.64 3.84";
        for number in decimals(&prose) {
            let is_there = |text: &str| decimals(text).any(|there| there == number);
            assert!(is_there(&ended.stdout) || is_there(known), "{number} in docs/results.md is in no table");
        }
        for number in FIGURES {
            let svg = fs::read_to_string(records.path(&format!("figure-{number:02}.svg"))).expect("a figure");
            let document = roxmltree::Document::parse(&svg).expect("well-formed");
            let named =
                document.descendants().filter(|node| node.has_tag_name("path") && node.has_children());
            assert!(named.count() >= 3, "figure {number}: a curve for each law");
            assert!(!svg.contains("no data"), "figure {number}");
        }
        let index = fs::read_to_string(records.path("index.html")).expect("the page");
        assert_eq!(index.matches("<svg ").count(), FIGURES.len());
        assert_eq!(fs::read_dir(records.out()).expect("the folder").count(), FIGURES.len() + 1);
    }
}

#[test]
fn a_folder_for_the_figures_that_cannot_be_made_is_named() {
    let ended =
        program::run(["paper", "figures", "--device", "inproc", "--out", "Cargo.toml/figures"]).with_code(2);
    assert!(ended.stderr.starts_with("lashloop: Cargo.toml/figures: can't be written: "), "{}", ended.stderr);
    assert_eq!(ended.stdout, "", "nothing has run");
}

#[test]
fn runs_for_the_figures_that_are_interrupted_leave_no_page() {
    let records = Records::new();
    fs::write(records.path("index.html"), "of an earlier time").expect("an old page");
    let bench = Running::start(["paper", "figures", "--device", "native", "--out", &records.out()]);
    wait::until("the old page is removed", || (!records.path("index.html").exists()).then_some(()));
    bench.signal(Signal::INT);
    let ended = bench.wait();
    assert_eq!(ended.code, Some(3), "{ended:?}");
    assert!(!records.path("index.html").exists());
    assert!(!ended.stdout.contains("figures:"), "{}", ended.stdout);
}
