//! The folder of a record: it belongs to one run, and none is overwritten without a word.

use std::fs;
use std::io;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};

use lashloop_bench::atomic_file::{WriteError, remove_if_present};

use crate::file_names::{ALL, LATEST};

/// A folder that a run may write to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RecordFolder {
    path: PathBuf,
}

/// Why a folder can't take a record.
#[derive(Debug, thiserror::Error)]
pub enum FolderError {
    /// It has one.
    #[error("{}: the folder holds a record ({file}); name another folder, or --force to replace it", path.display())]
    Taken {
        /// The folder.
        path: PathBuf,
        /// A file of the record.
        file: &'static str,
    },
    /// It can't be created.
    #[error("{}: cannot be created: {source}", path.display())]
    Create {
        /// The folder.
        path: PathBuf,
        /// The operating system's reason.
        source: io::Error,
    },
}

impl RecordFolder {
    /// Creates the folder if it doesn't exist. With `force` it may hold a record, which stays until the run begins: a run that
    /// the drive refuses replaces nothing.
    ///
    /// # Errors
    /// The folder holds a record, or can't be created.
    pub fn claim(path: &Path, force: bool) -> Result<Self, FolderError> {
        if !force && let Some(file) = record_in(path) {
            return Err(FolderError::Taken { path: path.to_owned(), file });
        }
        fs::create_dir_all(path).map_err(|source| FolderError::Create { path: path.to_owned(), source })?;
        Ok(Self { path: path.to_owned() })
    }

    /// Checks that no folder directly in `path` holds a record, before a command writes several there.
    ///
    /// # Errors
    /// One does, without `force`.
    pub fn check_inside(path: &Path, force: bool) -> Result<(), FolderError> {
        let Ok(entries) = fs::read_dir(path) else { return Ok(()) };
        let entries = entries.flatten().filter(|entry| entry.file_name() != LATEST);
        let folders = entries.map(|entry| entry.path());
        match folders.filter(|_| !force).find_map(|folder| Some((record_in(&folder)?, folder))) {
            Some((file, path)) => Err(FolderError::Taken { path, file }),
            None => Ok(()),
        }
    }

    /// The path.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Removes an earlier record.
    pub(crate) fn clear(&self) -> Result<(), WriteError> {
        ALL.iter().try_for_each(|file| remove_if_present(&self.path.join(file)))
    }

    /// Makes the symbolic link `latest`, next to the folder, point to it. A file or folder of this name stays.
    ///
    /// # Errors
    /// The link can't be made.
    pub(crate) fn link_latest(&self) -> io::Result<()> {
        let path = self.path.canonicalize()?;
        let (Some(parent), Some(name)) = (path.parent(), path.file_name()) else { return Ok(()) };
        let link = parent.join(LATEST);
        let is_other = |found: fs::Metadata| !found.file_type().is_symlink();
        if name == LATEST || fs::symlink_metadata(&link).is_ok_and(is_other) {
            return Ok(());
        }
        // A rename replaces the old link at once: there is no moment without one.
        let new = parent.join(format!(".{LATEST}-{}", std::process::id()));
        symlink(name, &new)?;
        fs::rename(&new, &link).inspect_err(|_| {
            let _ = fs::remove_file(&new);
        })
    }
}

/// A file of a record in the folder.
fn record_in(folder: &Path) -> Option<&'static str> {
    ALL.into_iter().rev().find(|file| folder.join(file).exists())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_record_is_replaced_only_by_force() {
        let parent = tempfile::tempdir().expect("a folder");
        let path = parent.path().join("a/b");
        RecordFolder::claim(&path, false).expect("a new folder");
        fs::write(path.join("notes.txt"), "mine").expect("a file");
        RecordFolder::claim(&path, false).expect("a folder without a record");
        fs::write(path.join("trace.csv"), "old").expect("a trace");
        let refused = RecordFolder::claim(&path, false).expect_err("a record").to_string();
        assert!(refused.contains("(trace.csv)") && refused.contains("--force"), "{refused}");
        let claimed = RecordFolder::claim(&path, true).expect("by force");
        assert!(path.join("trace.csv").exists(), "the record stays until the run begins");
        claimed.clear().expect("an empty folder");
        assert_eq!(fs::read_dir(&path).expect("the folder").count(), 1, "other files stay");
    }

    #[test]
    fn latest_points_to_the_last_record_and_replaces_no_folder() {
        let parent = tempfile::tempdir().expect("a folder");
        let claim = |name: &str| RecordFolder::claim(&parent.path().join(name), false).expect("a folder");
        for name in ["first", "second"] {
            claim(name).link_latest().expect("a link");
            assert_eq!(fs::read_link(parent.path().join(LATEST)).expect("a link"), Path::new(name));
        }
        fs::remove_file(parent.path().join(LATEST)).expect("no link");
        claim(LATEST).link_latest().expect("nothing to do");
        claim("third").link_latest().expect("nothing to do");
        assert!(parent.path().join(LATEST).is_dir() && !parent.path().join(LATEST).is_symlink());
    }
}
