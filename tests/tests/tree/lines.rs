//! The size of production code, and its limits.
//!
//! A code line is neither blank nor a comment, doc comments included, and belongs to no test-only item. Production code
//! is every library, program and build script of the repository but tests, their specimens and fuzzers. The length of a
//! file is all its lines.
//!
//! Each package has a limit in `lines/limits.rs`: the check fails above a limit and, once code was
//! removed, while its limit is too far above. It prints the table as it should be.

mod limits;

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::fs;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

use crate::directions::SourceTree;
use crate::metadata::Root;
use crate::{code_lines, metadata};
use limits::LIMITS;

/// Code lines of all packages together that we want: a goal, not a limit.
const GOAL: usize = 60_000;
/// Most code lines that a limit may be above its package.
const SLACK: usize = 100;
/// A limit is a multiple of this many code lines.
const STEP: usize = 50;
/// Most lines of a file, and of the median file.
const LONGEST_FILE: usize = 400;
const MEDIAN_FILE: usize = 150;
/// Packages without production code.
const TESTS: [&str; 3] = ["fuzz", "tests", "virtual-silicon/probe"];

#[test]
fn production_code_stays_within_its_limits() -> Result<()> {
    let mut code_lines_of = BTreeMap::<String, usize>::new();
    let mut lengths = Vec::new();
    for (package, files) in files_of_packages()? {
        for path in files {
            let text = fs::read_to_string(tests::workspace().join(&path))
                .with_context(|| format!("{} can't be read", path.display()))?;
            let lines = code_lines::count(&text).with_context(|| path.display().to_string())?;
            *code_lines_of.entry(package.display().to_string()).or_default() += lines;
            lengths.push((text.lines().count(), path));
        }
    }
    lengths.sort();
    let (median, _) = lengths.get(lengths.len() / 2).context("no file of production code")?;
    let total = code_lines_of.values().sum::<usize>();

    let mut table = String::new();
    for (package, lines) in &code_lines_of {
        writeln!(table, "{lines:6}  {package}")?;
    }
    writeln!(table, "{total:6}  code lines; the goal is {GOAL}")?;
    writeln!(table, "{} files, the median has {median} lines of at most {MEDIAN_FILE}", lengths.len())?;
    // Directly to the standard output: the test harness would keep what `print!` writes.
    io::stdout().lock().write_all(table.as_bytes())?;

    let files = lengths.iter().map(|(length, path)| (path.display().to_string(), *length, LONGEST_FILE));
    let too_long: Vec<_> = files
        .chain([("the median file".to_owned(), *median, MEDIAN_FILE)])
        .filter(|(_, lines, most)| lines > most)
        .map(|(what, lines, most)| format!("{what}: {lines} lines, at most {most} are allowed"))
        .collect();
    assert!(too_long.is_empty(), "{}", too_long.join("\n"));
    let wrong = wrong_limits(&code_lines_of, LIMITS);
    assert!(
        wrong.is_empty(),
        "{}\nrows of tests/tests/tree/lines/limits.rs for the code as it is:\n{}",
        wrong.join("\n"),
        rows_of_wrong(&code_lines_of, LIMITS)
    );
    Ok(())
}

/// Limits that are exceeded, too far above, missing or of no package, one sentence each.
fn wrong_limits(code_lines_of: &BTreeMap<String, usize>, limits: &[(&str, usize)]) -> Vec<String> {
    let limit_of: BTreeMap<_, _> = limits.iter().copied().collect();
    let packages = code_lines_of.iter().filter_map(|(package, lines)| match limit_of.get(package.as_str()) {
        None => Some(format!("{package}: {lines} code lines, and no limit")),
        Some(most) if lines > most => {
            Some(format!("{package}: {lines} code lines, at most {most} are allowed"))
        }
        Some(most) if *most > lines + SLACK => {
            Some(format!("{package}: {lines} code lines, so its limit of {most} must fall"))
        }
        Some(_) => None,
    });
    let is_unknown = |package: &&&str| !code_lines_of.contains_key(**package);
    let unknown = limit_of.keys().filter(is_unknown);
    packages.chain(unknown.map(|package| format!("{package}: a limit, and no such package"))).collect()
}

/// The rows that wrong limits should be, for this many code lines.
fn rows_of_wrong(code_lines_of: &BTreeMap<String, usize>, limits: &[(&str, usize)]) -> String {
    let limit_of: BTreeMap<_, _> = limits.iter().copied().collect();
    let is_wrong = |(package, lines): &(&String, &usize)| {
        limit_of.get(package.as_str()).is_none_or(|most| *lines > most || *most > *lines + SLACK)
    };
    let row = |(package, lines): (&String, &usize)| {
        let limit = lines.next_multiple_of(STEP);
        let limit =
            if limit < 1000 { limit.to_string() } else { format!("{}_{:03}", limit / 1000, limit % 1000) };
        format!("    ({package:?}, {limit}),\n")
    };
    code_lines_of.iter().filter(is_wrong).map(row).collect()
}

/// The production files of each package, by the package's folder.
fn files_of_packages() -> Result<BTreeMap<PathBuf, BTreeSet<PathBuf>>> {
    let mut files = BTreeMap::<PathBuf, BTreeSet<PathBuf>>::new();
    for Root { package, file } in metadata::production_roots()? {
        if !TESTS.iter().any(|folder| package == Path::new(folder)) {
            files.entry(package).or_default().extend(SourceTree::read(&file)?.files());
        }
    }
    Ok(files)
}

#[test]
fn a_limit_is_wrong_below_the_code_and_far_above_it() {
    let code_lines_of = |lines| BTreeMap::from([("host".to_owned(), lines)]);
    let wrong = |lines| wrong_limits(&code_lines_of(lines), &[("host", 1_000)]);
    assert_eq!(wrong(1_000), <[&str; 0]>::default());
    assert_eq!(wrong(900), <[&str; 0]>::default());
    assert_eq!(wrong(1_001), ["host: 1001 code lines, at most 1000 are allowed"]);
    assert_eq!(wrong(899), ["host: 899 code lines, so its limit of 1000 must fall"]);
    assert_eq!(rows_of_wrong(&code_lines_of(899), &[]), "    (\"host\", 900),\n");
    assert_eq!(rows_of_wrong(&code_lines_of(1_001), &[("host", 1_000)]), "    (\"host\", 1_050),\n");
}

#[test]
fn a_package_without_a_limit_and_a_limit_without_a_package_are_wrong() {
    let wrong = wrong_limits(&BTreeMap::from([("new".to_owned(), 7)]), &[("old", 50)]);
    assert_eq!(wrong, ["new: 7 code lines, and no limit", "old: a limit, and no such package"]);
}
