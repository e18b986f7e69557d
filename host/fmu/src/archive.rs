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
/// What a file or a folder takes besides its content.
const ENTRY: u64 = 4096;
/// Most entries, and names in the path of an entry.
const MOST_ENTRIES: usize = 100_000;
const DEEPEST: usize = 64;
const LARGEST_DESCRIPTION: u64 = 64 * MIB;
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
        let unreadable = |source| FmuError::File { file: file.clone(), source };
        // A pipe would make the program wait for a writer that may not exist.
        if !fs::metadata(path).map_err(unreadable)?.is_file() {
            return Err(unreadable(io::Error::other("it isn't a file")));
        }
        let opened = File::open(path).map_err(unreadable)?;
        let zip = ZipArchive::new(opened)
            .map_err(|error| FmuError::Archive { file: file.clone(), reason: error.to_string() })?;
        Ok(Self { zip, file })
    }

    /// The text of `modelDescription.xml`.
    pub(crate) fn description(&mut self) -> Result<String, FmuError> {
        self.description_within(LARGEST_DESCRIPTION)
    }

    fn description_within(&mut self, limit: u64) -> Result<String, FmuError> {
        let mut bytes = Vec::new();
        let entry = self.zip.by_name(DESCRIPTION).map_err(|error| error.to_string());
        let read = entry.and_then(|entry| {
            entry.take(limit + 1).read_to_end(&mut bytes).map_err(|error| error.to_string())
        });
        read.map_err(|reason| self.wrong(format!("{DESCRIPTION}: {reason}")))?;
        if bytes.len() as u64 > limit {
            return Err(FmuError::LargeDescription { limit: limit / MIB });
        }
        String::from_utf8(bytes).map_err(|error| self.wrong(format!("{DESCRIPTION}: {error}")))
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
        let count = self.zip.len();
        if count > MOST_ENTRIES {
            return Err(FmuError::TooMany { count, limit: MOST_ENTRIES });
        }
        let mut space = Space { limit, left: limit };
        for index in 0..count {
            let mut entry = self
                .zip
                .by_index(index)
                .map_err(|error| FmuError::Archive { file: self.file.clone(), reason: error.to_string() })?;
            let name = String::from_utf8_lossy(entry.name_raw()).into_owned();
            // A link could lead out of the folder, and the next entry through it.
            if entry.is_symlink() {
                return Err(FmuError::Link { entry: name });
            }
            let path = entry.enclosed_name().filter(|_| !name.starts_with('/'));
            let path = path.ok_or(FmuError::Escape { entry: name.clone() })?;
            if path.components().count() > DEEPEST {
                return Err(FmuError::TooDeep { entry: name, limit: DEEPEST });
            }
            let wrong = |error: io::Error| FmuError::Archive {
                file: self.file.clone(),
                reason: format!("{name}: {error}"),
            };
            let path = folder.join(path);
            let inner = if entry.is_dir() { Some(&*path) } else { path.parent() };
            let mut missing: Vec<_> =
                inner.into_iter().flat_map(Path::ancestors).take_while(|it| !it.exists()).collect();
            while let Some(folder) = missing.pop() {
                space.take(ENTRY)?;
                fs::create_dir(folder).map_err(wrong)?;
            }
            if !entry.is_dir() {
                space.take(ENTRY)?;
                let mut file = File::create(&path).map_err(wrong)?;
                // One more byte tells that there are too many. The size that the archive states may be wrong.
                let bytes = io::copy(&mut (&mut entry).take(space.left + 1), &mut file).map_err(wrong)?;
                space.take(bytes)?;
            }
        }
        Ok(())
    }

    fn wrong(&self, reason: String) -> FmuError {
        FmuError::Archive { file: self.file.clone(), reason }
    }
}

/// Bytes that an FMU may still take.
struct Space {
    limit: u64,
    left: u64,
}

impl Space {
    fn take(&mut self, bytes: u64) -> Result<(), FmuError> {
        let too_large = FmuError::TooLarge { limit: self.limit / MIB };
        self.left = self.left.checked_sub(bytes).ok_or(too_large)?;
        Ok(())
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
        let needs = 2 * MIB + 3 * ENTRY;
        archive.unpack_within(needs, folder.path()).expect("two files and their folder");
        assert_eq!(fs::metadata(folder.path().join("resources/b")).expect("a file").len(), MIB);
        let empty = tempfile::tempdir().expect("a folder");
        let error = archive.unpack_within(needs - 1, empty.path()).expect_err("a byte too many");
        assert!(error.to_string().starts_with("the FMU unpacks to more than 2 MiB"), "{error}");
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
        assert_eq!(
            error,
            "the FMU has a link \"resources\", which lashloop-fmu doesn't unpack; pack the file itself"
        );
    }

    #[test]
    fn many_entries_and_deep_ones_are_refused_before_they_fill_the_disk() {
        let options = SimpleFileOptions::default();
        let deep = |depth: usize| format!("{}a", "d/".repeat(depth));
        let (folder, mut archive) =
            packed(|zip| zip.start_file(deep(DEEPEST - 1), options).expect("an entry"));
        archive.unpack(folder.path()).expect("the deepest");
        // Each folder takes space, also those without content.
        let empty = tempfile::tempdir().expect("a folder");
        let needs = DEEPEST as u64 * ENTRY;
        let error = archive.unpack_within(needs - 1, empty.path()).expect_err("a folder too many");
        assert!(matches!(error, FmuError::TooLarge { .. }), "{error}");
        let (folder, mut archive) = packed(|zip| {
            zip.start_file(deep(DEEPEST), options).expect("an entry");
        });
        let error = archive.unpack(folder.path()).expect_err("too deep").to_string();
        assert!(error.ends_with("d/a\" in more than 64 folders; pack it into fewer"), "{error}");
        assert!(!folder.path().join("d").exists());
        let (folder, mut archive) = packed(|zip| {
            for index in 0..=MOST_ENTRIES {
                zip.add_directory(index.to_string(), options).expect("an entry");
            }
        });
        let error = archive.unpack(folder.path()).expect_err("too many").to_string();
        assert!(error.starts_with("the FMU has 100001 entries, and lashloop-fmu takes 100000;"), "{error}");
    }

    #[test]
    fn a_description_has_its_own_limit() {
        let (_folder, mut archive) = packed(|zip| {
            zip.start_file(DESCRIPTION, SimpleFileOptions::default()).expect("an entry");
            zip.write_all(&vec![b' '; MIB as usize]).expect("an entry");
        });
        assert_eq!(archive.description_within(MIB).expect("1 MiB").len() as u64, MIB);
        let error = archive.description_within(MIB - 1).expect_err("a byte too many").to_string();
        assert!(error.starts_with("the FMU's modelDescription.xml has more than 0 MiB"), "{error}");
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
