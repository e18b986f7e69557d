//! The processes that have a terminal open.

use std::fs;
use std::path::Path;

/// Name and process id of each that this user may inspect.
#[must_use]
pub fn of(terminal: &Path) -> Vec<String> {
    let Ok(terminal) = terminal.canonicalize() else { return Vec::new() };
    let processes = fs::read_dir("/proc").into_iter().flatten().flatten();
    let holds = |process: &Path| {
        let files = fs::read_dir(process.join("fd")).into_iter().flatten().flatten();
        files.filter_map(|file| fs::read_link(file.path()).ok()).any(|target| target == terminal)
    };
    let name = |process: &Path| {
        let id: u32 = process.file_name()?.to_str()?.parse().ok()?;
        let name = fs::read_to_string(process.join("comm")).ok()?;
        Some(format!("{} (process {id})", name.trim()))
    };
    processes
        .map(|process| process.path())
        .filter(|path| holds(path))
        .filter_map(|path| name(&path))
        .collect()
}
