//! The size of production code, and its limits.
//!
//! A code line is neither blank nor a comment, doc comments included, and belongs to no test-only item. Production code
//! is every library and program of the repository but the `tests` package and the fuzzers. The length of a file is all
//! its lines.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};

use crate::directions::SourceTree;
use crate::metadata::Root;
use crate::{code_lines, metadata, paths};

/// Most code lines of all production code.
const TOTAL: usize = 23_200;
/// Most code lines of the bench loop's crate.
const BENCH: usize = 12_000;
const BENCH_FOLDER: &str = "host/bench";
/// Most lines of a file, and of the median file.
const LONGEST_FILE: usize = 400;
const MEDIAN_FILE: usize = 150;

/// Packages outside the workspace.
const BENCHMARKS: [&str; 2] = ["benchmarks/codec", "benchmarks/plant"];

/// Prints the code lines of every crate and the lengths of files.
///
/// # Errors
/// A limit is exceeded, or a source can't be read.
pub(crate) fn check() -> Result<()> {
    let mut code_lines_of = BTreeMap::<PathBuf, usize>::new();
    let mut lengths = Vec::new();
    for (package, files) in files_of_packages()? {
        for path in files {
            let text = fs::read_to_string(paths::root().join(&path))
                .with_context(|| format!("{} can't be read", path.display()))?;
            let lines = code_lines::count(&text).with_context(|| path.display().to_string())?;
            *code_lines_of.entry(package.clone()).or_default() += lines;
            lengths.push((text.lines().count(), path));
        }
    }
    lengths.sort();
    let total = code_lines_of.values().sum::<usize>();
    for (package, lines) in &code_lines_of {
        println!("{lines:6}  {}", package.display());
    }
    println!("{total:6}  code lines of at most {TOTAL}");
    let median = lengths.get(lengths.len() / 2).map_or(0, |(length, _)| *length);
    println!("{} files, the median has {median} lines of at most {MEDIAN_FILE}", lengths.len());
    let bench =
        code_lines_of.get(&PathBuf::from(BENCH_FOLDER)).copied().context("there is no bench crate")?;
    let mut exceeded = Vec::new();
    for (length, path) in lengths.iter().filter(|(length, _)| *length > LONGEST_FILE) {
        exceeded.push(format!("{} has {length} lines, at most {LONGEST_FILE} are allowed", path.display()));
    }
    for (what, lines, most) in
        [("all crates", total, TOTAL), (BENCH_FOLDER, bench, BENCH), ("the median file", median, MEDIAN_FILE)]
    {
        if lines > most {
            exceeded.push(format!("{what}: {lines} lines, at most {most} are allowed"));
        }
    }
    ensure!(exceeded.is_empty(), "{}", exceeded.join("\n"));
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
