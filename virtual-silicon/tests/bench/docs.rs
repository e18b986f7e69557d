//! Tables of docs/hardware/stages.md against what the tests measure.

use std::fs;
use std::path::Path;
use std::time::Duration;

const PAGE: &str = "docs/hardware/stages.md";

/// The row that begins with these cells; the rest of its cells.
pub fn row(first: &str) -> Vec<String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(PAGE);
    let text = fs::read_to_string(path).expect("the page");
    let start = format!("| {first} |");
    let row = text.lines().find_map(|line| line.strip_prefix(&start)?.strip_suffix('|'));
    let row = row.unwrap_or_else(|| panic!("{PAGE} has no row {start:?}"));
    row.split('|').map(|cell| cell.trim().to_owned()).collect()
}

/// The numbers of a cell, in their order.
pub fn numbers(cell: &str) -> Vec<f64> {
    let words = cell.split_whitespace().map(|word| word.replace(',', ""));
    words.filter_map(|word| word.trim_end_matches(';').parse().ok()).collect()
}

/// A time in a cell: a number with `us`, `ms` or `periods`, or 0.
pub fn time(cell: &str, period: Duration) -> Duration {
    let (number, unit) = cell.split_once(' ').unwrap_or((cell, ""));
    let scale = match unit {
        "us" => Duration::from_micros(1),
        "ms" => Duration::from_millis(1),
        "period" | "periods" => period,
        "" => Duration::ZERO,
        _ => panic!("{PAGE}: {cell:?} has no unit"),
    };
    scale.mul_f64(number.parse().unwrap_or_else(|_| panic!("{PAGE}: {cell:?} isn't a time")))
}

/// What is wrong with a figure of the page: it is off by more than `tolerance`.
pub fn off(what: &str, documented: f64, measured: f64, tolerance: f64) -> Option<String> {
    ((documented - measured).abs() > tolerance)
        .then(|| format!("{PAGE} has {documented} for {what}, measured are {measured:.3}"))
}
