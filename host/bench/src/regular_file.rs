//! Files of others, read without waiting and without filling the memory.
//!
//! A pipe or a terminal would make the program wait for a writer that may not exist, and a device may have no end.

use std::fs::{self, File};
use std::io::{self, Error, ErrorKind, Read};
use std::os::unix::fs::FileTypeExt;
use std::path::Path;

/// Largest file that [`read`] takes, in bytes.
const LARGEST: u64 = 1 << 30;
/// Largest file that [`read_text`] takes, in bytes: a hundred times the manifest of a drive with every parameter.
const LARGEST_TEXT: u64 = 64 << 20;

/// Largest file that [`read_toml`] takes, in bytes.
const LARGEST_TOML: u64 = 4 << 20;

/// A regular file, open to be read.
#[derive(Debug)]
pub struct RegularFile {
    /// The file.
    pub file: File,
    /// Its size in bytes when it was opened.
    pub length: u64,
}

impl RegularFile {
    /// Opens a file. A symbolic link is followed.
    ///
    /// # Errors
    /// The file can't be opened, or is a folder, a pipe or a device.
    pub fn open(path: &Path) -> io::Result<Self> {
        if let Some(other) = other_kind(path)? {
            let kind = if other == "a folder" { ErrorKind::IsADirectory } else { ErrorKind::InvalidInput };
            return Err(Error::new(kind, format!("it is {other}, not a file")));
        }
        let file = File::open(path)?;
        let length = file.metadata()?.len();
        Ok(Self { file, length })
    }
}

/// What a path is, if it isn't a regular file.
///
/// # Errors
/// It doesn't exist, or can't be asked for.
pub fn other_kind(path: &Path) -> io::Result<Option<&'static str>> {
    let found = fs::metadata(path)?.file_type();
    Ok(match () {
        () if found.is_file() => None,
        () if found.is_dir() => Some("a folder"),
        () if found.is_fifo() => Some("a pipe"),
        () => Some("a device"),
    })
}

/// Reads a file of up to 1 GiB.
///
/// # Errors
/// As [`RegularFile::open`], or the file is larger.
pub fn read(path: &Path) -> io::Result<Vec<u8>> {
    up_to(path, LARGEST)
}

/// Reads a text of up to 64 MiB.
///
/// # Errors
/// As [`RegularFile::open`], or the file is larger or not in UTF-8.
pub fn read_text(path: &Path) -> io::Result<String> {
    text(up_to(path, LARGEST_TEXT)?)
}

/// Reads a text of up to 4 MiB that is to be parsed as TOML, whose parser takes a hundred times as much memory.
///
/// # Errors
/// As [`read_text`].
pub fn read_toml(path: &Path) -> io::Result<String> {
    text(up_to(path, LARGEST_TOML)?)
}

fn text(bytes: Vec<u8>) -> io::Result<String> {
    let invalid = |_| Error::new(ErrorKind::InvalidData, "it isn't a text in UTF-8");
    String::from_utf8(bytes).map_err(invalid)
}

fn up_to(path: &Path, limit: u64) -> io::Result<Vec<u8>> {
    let RegularFile { file, length } = RegularFile::open(path)?;
    if length > limit {
        let text = format!("it has {length} bytes; the limit is {limit}");
        return Err(Error::new(ErrorKind::FileTooLarge, text));
    }
    let mut bytes = Vec::with_capacity(length as usize);
    file.take(limit).read_to_end(&mut bytes)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_regular_file_of_bounded_size_is_read() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("text");
        fs::write(&path, "gap").expect("a file");
        assert_eq!(read_text(&path).expect("a text"), "gap");
        assert_eq!(read(&path).expect("bytes"), b"gap");
        let message = |path: &Path| read(path).expect_err("not a file").to_string();
        assert_eq!(message(folder.path()), "it is a folder, not a file");
        assert_eq!(message(Path::new("/dev/zero")), "it is a device, not a file");
        // Sparse: no byte of it is on the disk.
        File::create(&path).and_then(|file| file.set_len(1 << 40)).expect("a large file");
        assert_eq!(message(&path), "it has 1099511627776 bytes; the limit is 1073741824");
        fs::write(&path, [0xff]).expect("a file");
        assert_eq!(read_text(&path).expect_err("no text").to_string(), "it isn't a text in UTF-8");
    }
}
