//! Reports of the tests, which `cargo xtask test` prints.

use std::fs;
use std::path::Path;

/// Writes `target/reports/NAME.txt`.
pub fn write(name: &str, lines: &[String]) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../target/reports");
    fs::create_dir_all(&folder).expect("a folder for reports");
    let text: String = lines.iter().map(|line| format!("{line}\n")).collect();
    fs::write(folder.join(format!("{name}.txt")), text).expect("a report");
    lines.iter().for_each(|line| println!("{line}"));
}
