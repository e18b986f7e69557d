//! Files that are whole or not there.

use std::fs::{File, Permissions};
use std::io;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;

use super::RecordError;

/// Writes a file under its final name only when it is complete: into a temporary file in the same directory, then renamed.
/// `prefix` is how the temporary file is called.
///
/// # Errors
/// The directory isn't there or can't be written to, or `write` failed.
pub fn write_whole(
    path: &Path,
    prefix: &str,
    write: impl FnOnce(&mut File) -> io::Result<()>,
) -> Result<(), RecordError> {
    let error = |action| move |source| RecordError { path: path.to_owned(), action, source };
    let directory = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    // Temporary files are private by default; a record is for others as well, as far as the umask lets.
    let mut file = tempfile::Builder::new()
        .prefix(prefix)
        .permissions(Permissions::from_mode(0o666))
        .tempfile_in(directory)
        .map_err(error("created"))?;
    write(file.as_file_mut()).and_then(|()| file.as_file().sync_all()).map_err(error("written"))?;
    file.persist(path).map_err(|failure| error("written")(failure.error))?;
    Ok(())
}
