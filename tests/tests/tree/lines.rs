//! The size of production code, and its limits.
//!
//! A code line is neither blank nor a comment, doc comments included, and belongs to no test-only item. Production code
//! is every library and program of the repository but the `tests` package and the fuzzers. The length of a file is all
//! its lines.
//!
//! The limits are alarms, not budgets: growth beyond one needs a decision, in a commit that changes the number here. The
//! total is the size at the last decision, rounded up to the next 500 lines.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::fs;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

use crate::directions::SourceTree;
use crate::metadata::Root;
use crate::{code_lines, metadata};

/// Most code lines of all production code.
const TOTAL: usize = 66_000;
/// Most code lines of the bench loop's crate.
const BENCH: usize = 12_000;
const BENCH_FOLDER: &str = "host/bench";
/// Most lines of a file, and of the median file.
const LONGEST_FILE: usize = 400;
const MEDIAN_FILE: usize = 150;

/// Packages outside the workspace.
const BENCHMARKS: [&str; 2] = ["benchmarks/codec", "benchmarks/plant"];

#[test]
fn production_code_stays_within_its_limits() -> Result<()> {
    let mut code_lines_of = BTreeMap::<PathBuf, usize>::new();
    let mut lengths = Vec::new();
    for (package, files) in files_of_packages()? {
        for path in files {
            let text = fs::read_to_string(tests::workspace().join(&path))
                .with_context(|| format!("{} can't be read", path.display()))?;
            let lines = code_lines::count(&text).with_context(|| path.display().to_string())?;
            *code_lines_of.entry(package.clone()).or_default() += lines;
            lengths.push((text.lines().count(), path));
        }
    }
    lengths.sort();
    let total = code_lines_of.values().sum::<usize>();
    let (median, _) = lengths.get(lengths.len() / 2).context("no file of production code")?;
    let bench = code_lines_of.get(Path::new(BENCH_FOLDER)).context("no bench crate")?;

    let mut table = String::new();
    for (package, lines) in &code_lines_of {
        writeln!(table, "{lines:6}  {}", package.display())?;
    }
    writeln!(table, "{total:6}  code lines of at most {TOTAL}")?;
    writeln!(table, "{} files, the median has {median} lines of at most {MEDIAN_FILE}", lengths.len())?;
    // Directly to the standard output: the test harness would keep what `print!` writes.
    io::stdout().lock().write_all(table.as_bytes())?;

    let totals = [
        ("all crates", total, TOTAL),
        (BENCH_FOLDER, *bench, BENCH),
        ("the median file", *median, MEDIAN_FILE),
    ];
    let totals = totals.map(|(what, lines, most)| (what.to_owned(), lines, most));
    let files = lengths.iter().map(|(length, path)| (path.display().to_string(), *length, LONGEST_FILE));
    let exceeded: Vec<_> = files
        .chain(totals)
        .filter(|(_, lines, most)| lines > most)
        .map(|(what, lines, most)| format!("{what}: {lines} lines, at most {most} are allowed"))
        .collect();
    assert!(exceeded.is_empty(), "{}", exceeded.join("\n"));
    Ok(())
}

/// The production files of each package, by the package's folder.
fn files_of_packages() -> Result<BTreeMap<PathBuf, BTreeSet<PathBuf>>> {
    let mut roots = metadata::production_roots(&metadata::read()?)?;
    roots.retain(|root| root.package != Path::new("tests"));
    roots.extend(BENCHMARKS.map(|folder| {
        let package = PathBuf::from(folder);
        Root { file: package.join("src/main.rs"), package }
    }));
    let mut files = BTreeMap::<PathBuf, BTreeSet<PathBuf>>::new();
    for Root { package, file } in roots {
        files.entry(package).or_default().extend(SourceTree::read(&file)?.files());
    }
    Ok(files)
}
