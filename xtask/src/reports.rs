//! Results that are more than passed or failed, such as a kill rate of mutants. A test writes its lines as
//! `target/reports/NAME.txt`.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

use crate::paths;

/// The folder of the reports.
pub(crate) fn folder() -> PathBuf {
    paths::root().join("target/reports")
}

/// Deletes the reports of earlier runs.
///
/// # Errors
/// The folder can't be deleted.
pub(crate) fn clear(folder: &Path) -> Result<()> {
    match fs::remove_dir_all(folder) {
        Err(error) if error.kind() != ErrorKind::NotFound => {
            Err(error).with_context(|| format!("{} can't be deleted", folder.display()))
        }
        _ => Ok(()),
    }
}

/// The lines of all reports, in the order of the files' names.
///
/// # Errors
/// A report can't be read.
pub(crate) fn lines(folder: &Path) -> Result<Vec<String>> {
    let Ok(entries) = fs::read_dir(folder) else { return Ok(Vec::new()) };
    let mut paths = entries.map(|entry| Ok(entry?.path())).collect::<Result<Vec<_>>>()?;
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "txt"));
    paths.sort();
    let mut lines = Vec::new();
    for path in paths {
        let report =
            fs::read_to_string(&path).with_context(|| format!("{} can't be read", path.display()))?;
        lines.extend(report.lines().map(str::to_owned));
    }
    Ok(lines)
}

#[cfg(test)]
mod tests {
    use std::{env, fs, process};

    use super::{clear, lines};

    #[test]
    fn the_lines_of_text_files_are_reported_until_they_are_cleared() {
        let folder = env::temp_dir().join(format!("lashloop-reports-{}", process::id()));
        clear(&folder).expect("a missing folder isn't an error");
        assert!(lines(&folder).expect("no folder has no reports").is_empty());
        fs::create_dir(&folder).expect("a folder");
        for (name, text) in [("b.txt", "two\nthree\n"), ("a.txt", "one"), ("c.json", "{}")] {
            fs::write(folder.join(name), text).expect("a file");
        }
        assert_eq!(lines(&folder).expect("two reports"), ["one", "two", "three"]);
        clear(&folder).expect("a folder of ours");
        assert!(!folder.exists());
    }
}
