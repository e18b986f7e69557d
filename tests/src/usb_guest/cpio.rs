//! An archive in the format that the kernel unpacks as its first file system: cpio, "newc".

use std::collections::BTreeSet;
use std::path::Path;

/// Kind of a file in its mode.
const FOLDER: u32 = 0o040_000;
const FILE: u32 = 0o100_000;

/// An archive under construction.
#[derive(Default)]
pub struct Archive {
    bytes: Vec<u8>,
    folders: BTreeSet<String>,
    count: u32,
}

impl Archive {
    /// Adds a folder and those that it lies in.
    pub fn folder(&mut self, path: &str) {
        if let Some(parent) = Path::new(path).parent().and_then(Path::to_str).filter(|it| it.len() > 1) {
            self.folder(parent);
        }
        if self.folders.insert(path.to_owned()) {
            self.entry(path, FOLDER | 0o755, &[]);
        }
    }

    /// Adds a file with the folders that it lies in. `path` is absolute.
    pub fn file(&mut self, path: &str, mode: u32, contents: &[u8]) {
        if let Some(parent) = Path::new(path).parent().and_then(Path::to_str).filter(|it| it.len() > 1) {
            self.folder(parent);
        }
        self.entry(path, FILE | mode, contents);
    }

    /// The whole archive.
    #[must_use]
    pub fn finish(mut self) -> Vec<u8> {
        self.entry("/TRAILER!!!", 0, &[]);
        self.bytes
    }

    fn entry(&mut self, path: &str, mode: u32, contents: &[u8]) {
        let name = path.trim_start_matches('/');
        self.count += 1;
        let links = 1;
        let length = contents.len() as u32;
        let name_length = name.len() as u32 + 1;
        // Inode, mode, owner, group, links, time, length, four device numbers, length of the name, no check sum.
        let fields = [self.count, mode, 0, 0, links, 0, length, 0, 0, 0, 0, name_length, 0];
        self.bytes.extend_from_slice(b"070701");
        for field in fields {
            self.bytes.extend_from_slice(format!("{field:08X}").as_bytes());
        }
        self.bytes.extend_from_slice(name.as_bytes());
        self.bytes.push(0);
        self.align();
        self.bytes.extend_from_slice(contents);
        self.align();
    }

    fn align(&mut self) {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_are_aligned_and_folders_come_before_their_files() {
        let mut archive = Archive::default();
        archive.file("/lib/udev/a", 0o644, b"abcde");
        archive.file("/lib/b", 0o755, b"");
        let bytes = archive.finish();
        assert_eq!(bytes.len() % 4, 0);
        let heads: Vec<_> =
            (0..bytes.len()).step_by(4).filter(|at| bytes[*at..].starts_with(b"070701")).collect();
        let names = heads.iter().map(|at| {
            let name = &bytes[at + 110..];
            String::from_utf8_lossy(&name[..name.iter().position(|byte| *byte == 0).unwrap()]).into_owned()
        });
        assert_eq!(names.collect::<Vec<_>>(), ["lib", "lib/udev", "lib/udev/a", "lib/b", "TRAILER!!!"]);
        assert_eq!(&bytes[heads[2] + 14..heads[2] + 22], b"000081A4");
    }
}
