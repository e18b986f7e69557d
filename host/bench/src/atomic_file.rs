//! Files that are complete or don't exist.

use std::fs::{self, File, Permissions};
use std::io::{self, ErrorKind, Seek, SeekFrom, Write};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

/// A file that can't be written.
#[derive(Debug, thiserror::Error)]
#[error("{}: can't be {action}: {source}", path.display())]
pub struct WriteError {
    /// The file.
    pub path: PathBuf,
    /// `created`, `written` or `removed`.
    pub action: &'static str,
    /// The operating system's reason.
    pub source: io::Error,
}

/// Removes a file, if it exists.
///
/// # Errors
/// The file exists and can't be removed.
pub fn remove_if_present(path: &Path) -> Result<(), WriteError> {
    match fs::remove_file(path) {
        Err(source) if source.kind() != ErrorKind::NotFound => {
            Err(WriteError { path: path.to_owned(), action: "removed", source })
        }
        _ => Ok(()),
    }
}

/// Writes a temporary file in the same directory, then renames it, so that the name stands for a complete file. `prefix` begins
/// the temporary file's name.
///
/// # Errors
/// The directory doesn't exist or can't be written to, or `write` failed.
pub fn write_whole(
    path: &Path,
    prefix: &str,
    write: impl FnOnce(&mut File) -> io::Result<()>,
) -> Result<(), WriteError> {
    let error = |action| move |source| WriteError { path: path.to_owned(), action, source };
    let mut file = temporary_file(path, prefix).map_err(error("created"))?;
    write(file.as_file_mut()).and_then(|()| file.as_file().sync_all()).map_err(error("written"))?;
    file.persist(path).map_err(|failure| error("written")(failure.error))?;
    tracing::info!(file = %path.display(), "written");
    Ok(())
}

/// As [`write_whole`], for a writer that takes a path. A device or a pipe is written to in place, and a symbolic link stays.
///
/// # Errors
/// As [`write_whole`].
pub fn write_whole_at(
    path: &Path,
    prefix: &str,
    write: impl FnOnce(&Path) -> Result<(), WriteError>,
) -> Result<(), WriteError> {
    if fs::metadata(path).is_ok_and(|found| !found.is_file()) {
        return write(path);
    }
    let error = |action| move |source| WriteError { path: path.to_owned(), action, source };
    let place = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let temporary = temporary_file(&place, prefix).map_err(error("created"))?.into_temp_path();
    write(&temporary).map_err(|failure| error(failure.action)(failure.source))?;
    temporary.persist(&place).map_err(|failure| error("written")(failure.error))?;
    tracing::info!(file = %path.display(), "written");
    Ok(())
}

/// A file that grows by whole chunks.
#[derive(Debug)]
pub struct GrowingFile {
    path: PathBuf,
    file: File,
    /// Bytes of whole chunks in the file.
    written: u64,
    has_failed: bool,
}

impl GrowingFile {
    /// Creates the file. It replaces an older one once its first chunk is written, so that a full disk loses nothing. A
    /// device or a pipe is written to in place. `prefix` begins the temporary file's name.
    ///
    /// # Errors
    /// The directory doesn't exist or can't be written to, or the first chunk can't be written.
    pub fn create(path: &Path, prefix: &str, first: &[u8]) -> Result<Self, WriteError> {
        let file = begin(path, prefix, first)?;
        tracing::info!(file = %path.display(), "started");
        Ok(Self { path: path.to_owned(), file, written: first.len() as u64, has_failed: false })
    }

    /// Appends a chunk. After a failure no further one is appended: it would follow a gap.
    ///
    /// # Errors
    /// The chunk can't be written. The chunks before it are kept.
    pub fn append(&mut self, chunk: &[u8]) -> Result<(), WriteError> {
        let result = if self.has_failed {
            Err(io::Error::other("an earlier chunk could not be written"))
        } else {
            self.file.write_all(chunk)
        };
        self.has_failed = result.is_err();
        if result.is_ok() {
            self.written += chunk.len() as u64;
        } else {
            // A full disk may have taken part of the chunk. A failure to cut it off adds nothing to the first error.
            let _ = self.file.set_len(self.written);
            let _ = self.file.seek(SeekFrom::Start(self.written));
        }
        result.map_err(|source| WriteError { path: self.path.clone(), action: "written", source })
    }
}

fn begin(path: &Path, prefix: &str, first: &[u8]) -> Result<File, WriteError> {
    let error = |action| move |source| WriteError { path: path.to_owned(), action, source };
    if fs::metadata(path).is_ok_and(|found| !found.is_file()) {
        let mut file = File::create(path).map_err(error("created"))?;
        file.write_all(first).map_err(error("written"))?;
        return Ok(file);
    }
    // A symbolic link stays, and its target is replaced.
    let place = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let mut file = temporary_file(&place, prefix).map_err(error("created"))?;
    file.write_all(first).map_err(error("written"))?;
    file.persist(&place).map_err(|failure| error("written")(failure.error))
}

/// A temporary file in the same directory.
fn temporary_file(path: &Path, prefix: &str) -> io::Result<NamedTempFile> {
    let directory = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    // For the system's own error if the directory doesn't exist.
    fs::metadata(directory)?;
    // Temporary files are private by default; a record has the permissions that the umask leaves.
    let mut builder = tempfile::Builder::new();
    builder.prefix(prefix).permissions(Permissions::from_mode(0o666)).tempfile_in(directory)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The rename fails, because the name is that of a folder.
    #[test]
    fn a_file_that_cannot_be_created_changes_nothing() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("trace.csv");
        fs::create_dir(&path).expect("a folder in the way");
        fs::write(path.join("old"), "old").expect("something in it");
        assert!(begin(&path, ".trace-", b"new\n").is_err());
        assert_eq!(fs::read_to_string(path.join("old")).expect("still there"), "old");
        assert_eq!(fs::read_dir(folder.path()).expect("the folder").count(), 1);
    }

    #[test]
    fn an_older_file_stays_until_its_successor_is_written() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("trace.csv");
        fs::write(&path, "old").expect("an old file");
        let old = File::open(&path).expect("the old file");
        drop(begin(&path, ".trace-", b"new\n").expect("a new file"));
        // A reader that has the old file open still reads it: the file was replaced, not truncated.
        assert_eq!(io::read_to_string(old).expect("the old file"), "old");
        assert_eq!(fs::read_to_string(&path).expect("the new file"), "new\n");
    }

    #[test]
    fn a_created_file_grows_under_its_name() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("trace.csv");
        let mut file = GrowingFile::create(&path, ".trace-", b"a,b\n").expect("a file");
        file.append(b"1,2\n").expect("a row");
        assert_eq!(fs::read_to_string(&path).expect("the file"), "a,b\n1,2\n");
    }
}
