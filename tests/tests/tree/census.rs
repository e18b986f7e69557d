//! The bugs of the mutation census fit the tree: `cargo xtask census` plants them, which takes too long for every change.

use std::fs;
use std::path::Path;

use serde::Deserialize;

/// Fewest bugs of the list.
const LEAST: usize = 80;

#[derive(Deserialize)]
struct Bug {
    bug: String,
    file: String,
    text: String,
    becomes: String,
    at: String,
    test: String,
}

#[test]
fn each_bug_of_the_census_has_its_place_and_the_test_that_kills_it() {
    let root = tests::workspace();
    let list = fs::read_to_string(root.join("tests/census/board.json")).expect("the list");
    let bugs: Vec<Bug> = serde_json::from_str(&list).expect("a list of bugs");
    assert!(bugs.len() >= LEAST, "{} bugs", bugs.len());
    let sources = |folder: &str| sources(&root.join(folder));
    let tests = [
        ("unit", sources("firmware/src")),
        ("drive", sources("firmware/tests/drive")),
        ("store", sources("firmware/tests/store")),
        ("torque", sources("firmware/tests/torque")),
        ("usb", sources("tests/tests/usb_class")),
        ("identify", sources("host/identify/tests/identify")),
        ("", sources("virtual-silicon/tests")),
    ];
    let mut wrong = Vec::new();
    for Bug { bug, file, text, becomes, at, test } in &bugs {
        let folder = if file.starts_with("host/") { "" } else { "firmware/src" };
        let times = fs::read_to_string(root.join(folder).join(file)).map(|it| it.matches(text).count());
        if !matches!(times, Ok(1)) || text == becomes {
            wrong.push(format!("{bug}: {file} has its text {times:?} times"));
        }
        // Every other place is a board, whose image runs on virtual silicon.
        let of_place = tests.iter().find(|(place, _)| place == at).or(tests.last());
        if !of_place.is_some_and(|(_, sources)| sources.contains(&format!("fn {test}()"))) {
            wrong.push(format!("{bug}: no test {test} at {at}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Every source file below a folder.
fn sources(folder: &Path) -> String {
    let mut all = String::new();
    for entry in fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()) {
        if entry.is_dir() {
            all += &sources(&entry);
        } else if entry.extension().is_some_and(|it| it == "rs") {
            all += &fs::read_to_string(&entry).expect("a source file");
        }
    }
    all
}
