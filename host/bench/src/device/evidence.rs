//! The files that run as the drive: whether they are up to date, and their hashes for the record.

use std::fmt;
use std::fs::{self, File};
use std::io::{self, Read, Seek};
use std::num::NonZeroU32;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use lashloop_firmware::drive::{BUILD_ID, BUILD_IS_DIRTY};
use lashloop_protocol::hex::Hex;
use lashloop_protocol::message::Identity;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::regular_file::RegularFile;

/// The files that run as a drive, as its kind gives them.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct DriveFiles {
    /// The image or program, then further files that belong to it.
    pub paths: Vec<PathBuf>,
    /// What rebuilds them, if they are built from the sources of this bench.
    pub rebuilt_by: Option<&'static str>,
}

/// What a record keeps of the drive's origin.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Evidence {
    /// The files that ran as the drive; none for a board.
    pub files: Vec<FileHash>,
    /// Build of the bench, as [`Build`] displays it.
    pub bench_build: String,
    /// What casts doubt on the drive's origin.
    pub warnings: Vec<String>,
}

/// A file and its contents.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct FileHash {
    /// Path at the start of the session.
    pub path: String,
    /// SHA-256 of the contents in hexadecimal; `None` if they can't be read, which is a warning.
    pub sha256: Option<String>,
}

/// The files of an open drive. They are held open, so that a build that replaces them changes no hash.
pub(super) struct OpenFiles {
    files: Vec<(PathBuf, io::Result<File>)>,
    rebuilt_by: Option<&'static str>,
    stale: Option<PathBuf>,
}

impl OpenFiles {
    pub(super) fn open(files: DriveFiles) -> Self {
        let DriveFiles { paths, rebuilt_by } = files;
        let stale = rebuilt_by.and_then(|_| newer_source(paths.first()?));
        let files = paths
            .into_iter()
            .map(|path| (path.clone(), RegularFile::open(&path).map(|it| it.file)))
            .collect();
        Self { files, rebuilt_by, stale }
    }

    /// Whether the drive may be of another build than the bench.
    pub(super) fn warnings(&self, identity: &Identity) -> Vec<String> {
        let Some(rebuild) = self.rebuilt_by else { return Vec::new() };
        let path = self.files.first().map_or_else(String::new, |(path, _)| path.display().to_string());
        let build = differs(Build::of(identity), Build::OF_BENCH).then(|| {
            format!(
                "{path} is {}, this bench {}; `{rebuild}` builds it anew",
                Build::of(identity),
                Build::OF_BENCH
            )
        });
        let age = self.stale.as_ref().map(|source| {
            format!("{path} is older than its source {}; `{rebuild}` builds it anew", source.display())
        });
        build.into_iter().chain(age).collect()
    }

    pub(super) fn evidence(&self, identity: &Identity) -> Evidence {
        let mut warnings = self.warnings(identity);
        let hash = |(path, file): &(PathBuf, io::Result<File>)| match file {
            Ok(file) => FileHash::new(path, sha256(file), &mut warnings),
            Err(error) => FileHash::new(path, Err(error), &mut warnings),
        };
        let files = self.files.iter().map(hash).collect();
        Evidence { files, bench_build: Build::OF_BENCH.to_string(), warnings }
    }
}

impl FileHash {
    /// A file by what hashing it gave. A file that can't be read is a warning.
    pub fn new(path: &Path, hashed: Result<String, impl fmt::Display>, warnings: &mut Vec<String>) -> Self {
        let path = path.display().to_string();
        let unread = |error| warnings.push(format!("{path} can't be read, so its hash is unknown: {error}"));
        let sha256 = hashed.map_err(unread).ok();
        Self { path, sha256 }
    }
}

/// The sources of a build.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Build {
    /// First 32 bits of the commit; `None` if unknown.
    pub commit: Option<NonZeroU32>,
    /// Whether the sources may have had changes since that commit.
    pub is_dirty: bool,
}

impl Build {
    /// The firmware in this program, and so of the program itself: Cargo builds both from one tree.
    pub const OF_BENCH: Self = Self { commit: NonZeroU32::new(BUILD_ID), is_dirty: BUILD_IS_DIRTY };

    /// The build that a drive reports.
    #[must_use]
    pub fn of(identity: &Identity) -> Self {
        Self { commit: NonZeroU32::new(identity.build_id), is_dirty: identity.dirty != 0 }
    }
}

impl fmt::Display for Build {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.commit, self.is_dirty) {
            (None, _) => write!(out, "build unknown"),
            (Some(commit), false) => write!(out, "build {commit:08x}"),
            (Some(commit), true) => write!(out, "build {commit:08x} with changes"),
        }
    }
}

/// Whether a drive is of another build than the bench. An unknown commit is not compared. Changes of the bench alone are
/// left to the age of the files: most of them are none of the firmware.
fn differs(drive: Build, bench: Build) -> bool {
    match (drive.commit, bench.commit) {
        (Some(drive_commit), Some(bench_commit)) => {
            drive_commit != bench_commit || (drive.is_dirty && !bench.is_dirty)
        }
        _ => false,
    }
}

fn sha256(mut file: &File) -> io::Result<String> {
    let (mut hash, mut piece) = (Sha256::new(), vec![0; 1 << 16]);
    file.rewind()?;
    loop {
        match file.read(&mut piece)? {
            0 => break,
            count => hash.update(&piece[..count]),
        }
    }
    Ok(Hex(&hash.finalize()).to_string())
}

/// The source that was changed last, if that was after `program` was built. Cargo lists the sources of a program in a file
/// next to it; without the list, or on a machine without the sources, nothing is compared.
fn newer_source(program: &Path) -> Option<PathBuf> {
    let built = modified(program)?;
    let list = fs::read_to_string(program.with_extension("d")).ok()?;
    let newest = sources(&list)
        // A commit doesn't change a source, and the build id has it.
        .filter(|path| !path.components().any(|part| part.as_os_str() == ".git"))
        // A folder changes with every file that an editor keeps in it.
        .filter(|path| path.is_file())
        .filter_map(|path| Some((modified(&path)?, path)))
        .max()?;
    (newest.0 > built).then_some(newest.1)
}

fn modified(path: &Path) -> Option<SystemTime> {
    fs::metadata(path).and_then(|file| file.modified()).ok()
}

/// The sources in a list of Cargo: `program: source source`, in the syntax of make, where a backslash precedes a space of a
/// path.
fn sources(list: &str) -> impl Iterator<Item = PathBuf> {
    let sources = list.lines().filter_map(|line| line.split_once(": ")).map(|(_, sources)| sources);
    sources.flat_map(|sources| {
        let mut paths = vec![String::new()];
        let mut characters = sources.chars().peekable();
        while let Some(character) = characters.next() {
            match (character, paths.last_mut()) {
                ('\\', Some(path)) if characters.peek() == Some(&' ') => path.extend(characters.next()),
                (' ', _) => paths.push(String::new()),
                (_, Some(path)) => path.push(character),
                (_, None) => {}
            }
        }
        paths.into_iter().filter(|path| !path.is_empty()).map(PathBuf::from)
    })
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    fn touch(path: &Path, contents: &str, age_s: u64) {
        fs::write(path, contents).unwrap();
        let file = File::options().append(true).open(path).unwrap();
        file.set_modified(SystemTime::now() - Duration::from_secs(age_s)).unwrap();
    }

    #[test]
    fn a_program_older_than_a_source_is_stale_and_a_commit_is_no_source() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::create_dir_all(at(".git")).unwrap();
        let [law, main, head, program] = ["a law.rs", "main.rs", ".git/HEAD", "drive.elf"].map(at);
        touch(&law, "", 300);
        touch(&main, "", 200);
        touch(&head, "", 0);
        touch(&program, "", 100);
        assert_eq!(newer_source(&program), None, "no list");
        let escaped = law.display().to_string().replace(' ', "\\ ");
        let list = format!("/x/drive: {escaped} {} {} /none.rs\n", main.display(), head.display());
        touch(&program.with_extension("d"), &list, 100);
        assert_eq!(newer_source(&program), None);
        touch(&law, "changed", 50);
        assert_eq!(newer_source(&program), Some(law.clone()));
        let files = DriveFiles { paths: vec![program.clone()], rebuilt_by: Some("make") };
        assert_eq!(OpenFiles::open(files).stale, Some(law));
        let foreign = OpenFiles::open(DriveFiles { paths: vec![program], rebuilt_by: None });
        assert_eq!(foreign.stale, None, "a foreign drive has other sources");
    }

    #[test]
    fn the_hash_is_that_of_the_file_at_the_start() {
        let folder = tempfile::tempdir().unwrap();
        let [image, other] = ["image", "other"].map(|name| folder.path().join(name));
        fs::write(&image, "abc").unwrap();
        let open = OpenFiles::open(DriveFiles { paths: vec![image.clone()], rebuilt_by: None });
        fs::write(&other, "abd").unwrap();
        fs::rename(&other, &image).unwrap();
        let (_, file) = &open.files[0];
        let abc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(sha256(file.as_ref().unwrap()).unwrap(), abc);
    }

    #[test]
    fn builds_differ_by_commit_and_by_changes_of_the_drive() {
        let build = |commit, is_dirty| Build { commit: NonZeroU32::new(commit), is_dirty };
        for (drive, bench, want) in [
            (build(1, false), build(1, false), false),
            (build(1, false), build(2, false), true),
            (build(1, true), build(1, false), true),
            (build(1, true), build(1, true), false),
            (build(1, false), build(1, true), false),
            (build(0, true), build(2, false), false),
            (build(1, true), build(0, true), false),
        ] {
            assert_eq!(differs(drive, bench), want, "{drive:?} {bench:?}");
        }
        assert_eq!(build(0xc0_ffee, true).to_string(), "build 00c0ffee with changes");
        assert_eq!(build(0, true).to_string(), "build unknown");
    }
}
