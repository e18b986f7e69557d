//! The archive of an FMU.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;

use zip::ZipArchive;

use crate::error::FmuError;

/// Most bytes that an FMU may unpack to. Libraries of large tools have some 100 MiB.
const LARGEST: u64 = 2 << 30;
const MIB: u64 = 1 << 20;
const DESCRIPTION: &str = "modelDescription.xml";

/// An open FMU.
#[derive(Debug)]
pub(crate) struct Archive {
    zip: ZipArchive<File>,
    file: String,
}

impl Archive {
    pub(crate) fn open(path: &Path) -> Result<Self, FmuError> {
        let file = path.display().to_string();
        let opened = File::open(path).map_err(|source| FmuError::File { file: file.clone(), source })?;
        let zip = ZipArchive::new(opened)
            .map_err(|error| FmuError::Archive { file: file.clone(), reason: error.to_string() })?;
        Ok(Self { zip, file })
    }

    /// The text of `modelDescription.xml`.
    pub(crate) fn description(&mut self) -> Result<String, FmuError> {
        let mut text = String::new();
        let entry = self.zip.by_name(DESCRIPTION).map_err(|error| error.to_string());
        let read = entry.and_then(|entry| {
            entry.take(64 * MIB).read_to_string(&mut text).map_err(|error| error.to_string())
        });
        read.map_err(|reason| self.wrong(format!("{DESCRIPTION}: {reason}")))?;
        Ok(text)
    }

    /// Names of the files in a folder of the archive.
    fn inside(&self, folder: &str) -> impl Iterator<Item = String> {
        let names = self.zip.file_names().filter_map(Result::ok);
        names.filter_map(move |name| name.strip_prefix(folder).map(str::to_owned))
    }

    /// The platforms with a binary, in the names of FMI.
    pub(crate) fn platforms(&self) -> Vec<String> {
        let is_file = |(_, file): &(&str, &str)| !file.is_empty();
        let platform =
            |path: String| path.split_once('/').filter(is_file).map(|(platform, _)| platform.to_owned());
        let platforms: BTreeSet<_> = self.inside("binaries/").filter_map(platform).collect();
        platforms.into_iter().collect()
    }

    /// Whether it has C sources.
    pub(crate) fn has_sources(&self) -> bool {
        self.inside("sources/").any(|path| path.ends_with(".c"))
    }

    /// Unpacks everything into a folder.
    pub(crate) fn unpack(&mut self, folder: &Path) -> Result<(), FmuError> {
        self.unpack_within(LARGEST, folder)
    }

    fn unpack_within(&mut self, limit: u64, folder: &Path) -> Result<(), FmuError> {
        let mut left = limit;
        for index in 0..self.zip.len() {
            let mut entry = self
                .zip
                .by_index(index)
                .map_err(|error| FmuError::Archive { file: self.file.clone(), reason: error.to_string() })?;
            let name = String::from_utf8_lossy(entry.name_raw()).into_owned();
            // A link could lead out of the folder, and the next entry through it.
            let path = entry.enclosed_name().filter(|_| !entry.is_symlink() && !name.starts_with('/'));
            let path = folder.join(path.ok_or(FmuError::Escape { entry: name.clone() })?);
            let mut unpack = |path: &Path| {
                if entry.is_dir() {
                    return fs::create_dir_all(path).map(|()| 0);
                }
                fs::create_dir_all(path.parent().unwrap_or(path))?;
                // One more byte tells that there are too many. The size that the archive states may be wrong.
                io::copy(&mut (&mut entry).take(left + 1), &mut File::create(path)?)
            };
            let bytes = unpack(&path).map_err(|error| FmuError::Archive {
                file: self.file.clone(),
                reason: format!("{name}: {error}"),
            })?;
            left = left.checked_sub(bytes).ok_or(FmuError::TooLarge { limit: limit / MIB })?;
        }
        Ok(())
    }

    fn wrong(&self, reason: String) -> FmuError {
        FmuError::Archive { file: self.file.clone(), reason }
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write as _;

    use zip::ZipWriter;
    use zip::write::SimpleFileOptions;

    use super::*;

    fn packed(fill: impl FnOnce(&mut ZipWriter<File>)) -> (tempfile::TempDir, Archive) {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.fmu");
        let mut zip = ZipWriter::new(File::create(&path).expect("a file"));
        fill(&mut zip);
        zip.finish().expect("an archive");
        (folder, Archive::open(&path).expect("an archive"))
    }

    #[test]
    fn an_archive_unpacks_up_to_its_limit_whatever_it_states() {
        let fill = |zip: &mut ZipWriter<File>| {
            for name in ["resources/a", "resources/b"] {
                zip.start_file(name, SimpleFileOptions::default()).expect("an entry");
                zip.write_all(&vec![0; MIB as usize]).expect("an entry");
            }
        };
        let (folder, mut archive) = packed(fill);
        archive.unpack_within(2 * MIB, folder.path()).expect("2 MiB");
        assert_eq!(fs::metadata(folder.path().join("resources/b")).expect("a file").len(), MIB);
        let error = archive.unpack_within(2 * MIB - 1, folder.path()).expect_err("a byte too many");
        assert!(error.to_string().starts_with("the FMU unpacks to more than 1 MiB"), "{error}");
    }

    #[test]
    fn an_entry_or_a_link_that_leaves_the_folder_is_named() {
        let options = SimpleFileOptions::default();
        for name in ["../a", "/etc/a", "resources/../../a"] {
            let (folder, mut archive) = packed(|zip| zip.start_file(name, options).expect("an entry"));
            let error = archive.unpack(folder.path()).expect_err(name).to_string();
            assert!(error.contains(&format!("an entry {name:?} that leaves its folder")), "{error}");
        }
        let (folder, mut archive) =
            packed(|zip| zip.add_symlink("resources", "/etc", options).expect("a link"));
        let error = archive.unpack(folder.path()).expect_err("a link").to_string();
        assert!(error.contains("an entry \"resources\" that leaves"), "{error}");
    }

    #[test]
    fn platforms_are_the_folders_with_binaries() {
        let (_folder, archive) = packed(|zip| {
            for name in
                ["binaries/win64/a.dll", "binaries/win64/b.dll", "binaries/darwin64/a.dylib", "sources/a.c"]
            {
                zip.start_file(name, SimpleFileOptions::default()).expect("an entry");
            }
            zip.add_directory("binaries/linux64/", SimpleFileOptions::default()).expect("an entry");
        });
        assert_eq!(archive.platforms(), ["darwin64", "win64"]);
        assert!(archive.has_sources());
    }
}
