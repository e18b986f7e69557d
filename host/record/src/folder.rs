//! The folder of a record: it belongs to one run at a time, no record is overwritten without `--force`, and no other file ever.

use std::fs::{self, File};
use std::io::{self, ErrorKind};
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};

use lashloop_bench::atomic_file::{WriteError, remove_if_present};
use lashloop_bench::{regular_file, resume};
use serde::Deserialize;
use toml_edit::DocumentMut;

use crate::file_names::{ALL, DERIVED, LATEST, MANIFEST_FILE, REFERENCE_FILE, REPORT_FILE, SCENARIO_FILE};

/// Folder in which a record begins, until all its files are there.
const NEW: &str = ".new";

/// A folder that this process alone writes a record to, until it is dropped.
#[derive(Debug)]
pub struct RecordFolder {
    path: PathBuf,
    force: bool,
    /// `None` on a file system that locks no folders, such as NFS. There the second look at the start is all there is.
    _lock: Option<File>,
}

/// Why a folder can't take a record.
#[derive(Debug, thiserror::Error)]
pub enum FolderError {
    /// It has one.
    #[error("{}: the folder holds a record ({MANIFEST_FILE}); name another folder, or --force to replace it", path.display())]
    Taken {
        /// The folder.
        path: PathBuf,
    },
    /// A record would replace a file that belongs to none.
    #[error("{}: the folder has {file} and no record: the run would replace that file; name another folder", path.display())]
    Foreign {
        /// The folder.
        path: PathBuf,
        /// The file.
        file: &'static str,
    },
    /// Another process writes a record to it.
    #[error("{}: another lashloop writes a record to the folder: wait for its end, or name another folder", path.display())]
    InUse {
        /// The folder.
        path: PathBuf,
    },
    /// A record would replace the scenario that is run.
    #[error("{}: the run would replace its own scenario; name another folder", path.display())]
    Source {
        /// The scenario.
        path: PathBuf,
    },
    /// An output would replace a file of a record.
    #[error("{}: the file is part of a record; name another file", path.display())]
    Recorded {
        /// The file.
        path: PathBuf,
    },
    /// It can't be created.
    #[error("{}: can't be created: {source}", path.display())]
    Create {
        /// The folder.
        path: PathBuf,
        /// The operating system's reason.
        source: io::Error,
    },
}

/// What a folder holds.
enum Content {
    Nothing,
    /// A record.
    Record,
    /// A file with the name of one of a record, and no record.
    Foreign(&'static str),
}

impl RecordFolder {
    /// Creates the folder if it doesn't exist, and keeps other processes out. With `force` it may hold a record, which stays
    /// until the run begins: a run that the drive refuses replaces nothing.
    ///
    /// # Errors
    /// The folder holds a record or files of the user, is in use, or can't be created.
    pub fn claim(path: &Path, force: bool) -> Result<Self, FolderError> {
        let failed = |source| FolderError::Create { path: path.to_owned(), source };
        fs::create_dir_all(path).map_err(failed)?;
        let lock = lock(path)?;
        complete(path).map_err(failed)?;
        let folder = Self { path: path.to_owned(), force, _lock: lock };
        match content(path) {
            Content::Record if !force => Err(FolderError::Taken { path: folder.path }),
            Content::Foreign(file) => Err(FolderError::Foreign { path: folder.path, file }),
            Content::Record | Content::Nothing => Ok(folder),
        }
    }

    /// Checks that no folder directly in `path` holds a record, before a command writes several there.
    ///
    /// # Errors
    /// One does, without `force`.
    pub fn check_inside(path: &Path, force: bool) -> Result<(), FolderError> {
        let Ok(entries) = fs::read_dir(path) else { return Ok(()) };
        let entries = entries.flatten().filter(|entry| entry.file_name() != LATEST);
        let taken = entries.map(|entry| entry.path()).find_map(|folder| match content(&folder) {
            Content::Record if !force => Some(FolderError::Taken { path: folder }),
            _ => None,
        });
        taken.map_or(Ok(()), Err)
    }

    /// Checks that the record will not replace the scenario of its run.
    ///
    /// # Errors
    /// It would.
    pub fn check_source(&self, scenario: &Path) -> Result<(), FolderError> {
        let is_inside = scenario.parent().is_some_and(|parent| {
            let parent = if parent.as_os_str().is_empty() { Path::new(".") } else { parent };
            parent.canonicalize().is_ok_and(|it| self.path.canonicalize().is_ok_and(|here| here == it))
        });
        let is_replaced = is_inside && ALL.iter().any(|name| scenario.file_name() == Some(name.as_ref()));
        if is_replaced { Err(FolderError::Source { path: scenario.to_owned() }) } else { Ok(()) }
    }

    /// Checks that a file that a command is to write is not part of a record.
    ///
    /// # Errors
    /// It is.
    pub fn check_output(file: &Path) -> Result<(), FolderError> {
        let is_of_record = ALL.iter().any(|name| file.file_name() == Some(name.as_ref()))
            && file.parent().is_some_and(|folder| matches!(content(folder), Content::Record));
        if is_of_record { Err(FolderError::Recorded { path: file.to_owned() }) } else { Ok(()) }
    }

    /// Removes a link, a pipe or a device that has the name of a file to be written. Whoever made the folder would decide by it
    /// where the file goes.
    ///
    /// # Errors
    /// It can't be removed.
    pub fn remove_detour(file: &Path) -> Result<(), WriteError> {
        let is_detour = |found: fs::Metadata| !found.is_file() && !found.is_dir();
        if fs::symlink_metadata(file).is_ok_and(is_detour) { remove_if_present(file) } else { Ok(()) }
    }

    /// The path.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Removes the record that the folder holds, what was derived from it, and the folder unless it has other files.
    ///
    /// # Errors
    /// A file can't be removed.
    pub fn remove(self) -> Result<(), WriteError> {
        self.clear()?;
        remove_folder(&self.path.join(NEW))?;
        let latest = self.path.with_file_name(LATEST);
        if fs::read_link(&latest).is_ok_and(|target| Some(target.as_os_str()) == self.path.file_name()) {
            remove_if_present(&latest)?;
        }
        match fs::remove_dir(&self.path) {
            Err(source) if source.kind() != ErrorKind::DirectoryNotEmpty => {
                Err(WriteError { path: self.path, action: "removed", source })
            }
            _ => Ok(()),
        }
    }

    /// Puts the files of a new record into the folder. `write` writes them to a folder in it: until all are there, an
    /// earlier record stays, so that a full disk loses none.
    pub(crate) fn begin<T>(
        &self,
        write: impl FnOnce(&Path) -> Result<T, WriteError>,
    ) -> Result<T, WriteError> {
        // Much later than the claim, if the run waited for a reader of its live page.
        let later = match content(&self.path) {
            Content::Record if !self.force => Some(MANIFEST_FILE),
            Content::Foreign(file) => Some(file),
            _ => None,
        };
        let in_the_way = |problem: String| {
            let source = io::Error::other(problem + "; name another folder");
            WriteError { path: self.path.clone(), action: "written", source }
        };
        if let Some(file) = later {
            return Err(in_the_way(format!("{file} is there since the command began")));
        }
        let new = self.path.join(NEW);
        remove_folder(&new)?;
        let created = fs::create_dir(&new);
        created.map_err(|source| WriteError { path: self.path.clone(), action: "written", source })?;
        let result = write(&new).and_then(|written| {
            let has_table = |folder: &Path| folder.join(REFERENCE_FILE).exists();
            if has_table(&new) && has_table(&self.path) && !self.owns(REFERENCE_FILE) {
                return Err(in_the_way(format!("{REFERENCE_FILE} is there and part of no record")));
            }
            self.clear()?;
            let moved = move_files(&new, &self.path);
            moved.map_err(|(path, source)| WriteError { path, action: "written", source })?;
            Ok(written)
        });
        // What is left of it is empty, or the files of a record that did not begin; the first error says why.
        let _ = remove_folder(&new);
        result.map_err(|error| self.named(error))
    }

    /// The error of a file under the name that it has in the folder, wherever it began.
    pub(crate) fn named(&self, error: WriteError) -> WriteError {
        match error.path.strip_prefix(self.path.join(NEW)) {
            Ok(name) => WriteError { path: self.path.join(name), ..error },
            Err(_) => error,
        }
    }

    /// Removes an earlier record and what was derived from it.
    pub(crate) fn clear(&self) -> Result<(), WriteError> {
        match content(&self.path) {
            Content::Record => {
                let owned: Vec<_> = DERIVED.iter().chain(&ALL).filter(|file| self.owns(file)).collect();
                owned.into_iter().try_for_each(|file| remove_if_present(&self.path.join(file)))
            }
            Content::Nothing | Content::Foreign(_) => Ok(()),
        }
    }

    /// Whether a file of this name is part of the record that the folder holds: a table of a reference only if the recorded
    /// scenario names it.
    fn owns(&self, file: &str) -> bool {
        let names_table = || {
            let text = regular_file::read_toml(&self.path.join(SCENARIO_FILE)).ok()?;
            let document: DocumentMut = text.parse().ok()?;
            Some(document.get("reference")?.get("file")?.as_str()? == REFERENCE_FILE)
        };
        file != REFERENCE_FILE || names_table() == Some(true)
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

/// Locks a folder. It leaves no file, and the kernel releases it with the process, however that ends.
fn lock(path: &Path) -> Result<Option<File>, FolderError> {
    let file = File::open(path).map_err(|source| FolderError::Create { path: path.to_owned(), source })?;
    match resume::lock(&file) {
        Ok(true) => Ok(Some(file)),
        Ok(false) => Err(FolderError::InUse { path: path.to_owned() }),
        Err(_) => Ok(None),
    }
}

/// A record has a manifest.
fn content(folder: &Path) -> Content {
    let has = |name: &&str| fs::symlink_metadata(folder.join(name)).is_ok();
    if has_manifest(folder) {
        return Content::Record;
    }
    let foreign = ALL.iter().rev().chain([&REPORT_FILE]).copied().find(has);
    foreign.map_or(Content::Nothing, Content::Foreign)
}

/// What every manifest has. A file of the user may have its name.
#[derive(Deserialize)]
struct ManifestHead {
    #[serde(rename = "format")]
    _format: u32,
}

fn has_manifest(folder: &Path) -> bool {
    let text = regular_file::read_text(&folder.join(MANIFEST_FILE)).unwrap_or_default();
    serde_json::from_str::<ManifestHead>(&text).is_ok()
}

/// Completes the start of a record that a kill has cut short between its renames.
fn complete(folder: &Path) -> io::Result<()> {
    let new = folder.join(NEW);
    let is_in_both = |name: &&str| new.join(name).exists() && folder.join(name).exists();
    if !has_manifest(&new) || ALL.iter().any(is_in_both) || folder.join(MANIFEST_FILE).exists() {
        return Ok(());
    }
    move_files(&new, folder).map_err(|(_, source)| source)?;
    fs::remove_dir(new)
}

/// Moves the files of a record in their order; an error has its file.
fn move_files(from: &Path, to: &Path) -> Result<(), (PathBuf, io::Error)> {
    ALL.into_iter().try_for_each(|name| match fs::rename(from.join(name), to.join(name)) {
        Err(source) if source.kind() != ErrorKind::NotFound => Err((to.join(name), source)),
        _ => Ok(()),
    })
}

fn remove_folder(path: &Path) -> Result<(), WriteError> {
    match fs::remove_dir_all(path) {
        Err(source) if source.kind() != ErrorKind::NotFound => {
            Err(WriteError { path: path.to_owned(), action: "removed", source })
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests;
