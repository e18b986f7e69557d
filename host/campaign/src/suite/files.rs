//! The scenarios of files and folders.

use std::path::{Path, PathBuf};
use std::{fs, io};

use super::baseline;

/// A path that has no scenario.
#[derive(Debug, thiserror::Error)]
pub enum FilesError {
    #[error("{}: can't be read: {source}", path.display())]
    Read { path: PathBuf, source: io::Error },
    #[error("{}: the folder has no scenario; a scenario is a file with the ending .toml", path.display())]
    Empty { path: PathBuf },
}

/// The files of `paths`, each once, in the order of the paths; those of a folder and its subfolders in the order of their
/// names. A folder's scenarios are its files with the ending `.toml`; hidden ones and baselines are none. Links to folders
/// are not followed, because they can form a loop.
///
/// # Errors
/// A path can't be read, or a folder has no scenario.
pub fn find(paths: &[PathBuf]) -> Result<Vec<PathBuf>, FilesError> {
    let mut files: Vec<PathBuf> = Vec::new();
    for path in paths {
        let of_path = if path.is_dir() { in_folder(path)? } else { vec![path.clone()] };
        if of_path.is_empty() {
            return Err(FilesError::Empty { path: path.clone() });
        }
        for file in of_path {
            if !files.contains(&file) {
                files.push(file);
            }
        }
    }
    Ok(files)
}

fn in_folder(folder: &Path) -> Result<Vec<PathBuf>, FilesError> {
    let failed = |source| FilesError::Read { path: folder.to_owned(), source };
    let entries: Result<Vec<_>, _> = fs::read_dir(folder).map_err(failed)?.collect();
    let mut entries = entries.map_err(failed)?;
    entries.sort_by_key(fs::DirEntry::file_name);
    let mut files = Vec::new();
    for entry in entries {
        let (path, name) = (entry.path(), entry.file_name().to_string_lossy().into_owned());
        if name.starts_with('.') {
            continue;
        }
        if entry.file_type().map_err(failed)?.is_dir() {
            files.extend(in_folder(&path)?);
        } else if name.ends_with(".toml") && !name.ends_with(baseline::ENDING) {
            files.push(path);
        }
    }
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_has_its_scenarios_in_the_order_of_names() {
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        for name in
            ["b.toml", "a.toml", "a.baseline.toml", ".hidden.toml", "readme.md", "sub/c.toml", ".git/d.toml"]
        {
            fs::create_dir_all(at(name).parent().expect("a folder")).expect("a folder");
            fs::write(at(name), "").expect("a file");
        }
        std::os::unix::fs::symlink(folder.path(), at("sub/loop")).expect("a link");
        let found = find(&[at("sub/c.toml"), folder.path().to_owned()]).expect("scenarios");
        assert_eq!(found, ["sub/c.toml", "a.toml", "b.toml"].map(at));
        fs::create_dir(at("empty")).expect("a folder");
        assert!(matches!(find(&[at("empty")]), Err(FilesError::Empty { .. })));
        // Its error is that of a scenario, a row of its own.
        assert_eq!(find(&[at("none.toml")]).expect("a row"), [at("none.toml")]);
    }
}
