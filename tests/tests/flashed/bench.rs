//! An image, programs that stand for others, and `lashloop flash` with a `PATH` of its own.

use std::ffi::OsString;
use std::fs::{self, Permissions};
use std::os::unix::fs::PermissionsExt;
use std::path::PathBuf;
use std::process::Command;

use lashloop_firmware::drive::{BUILD_ID, BUILD_IS_DIRTY};
use tempfile::TempDir;
use tests::elf::Elf;
use tests::program::{self, Ended, Running};

/// Size of the images: more than a sector, and no multiple of a block of any loader.
pub(crate) const SIZE: usize = 20_004;

/// A folder with an image and with programs.
pub(crate) struct Workbench {
    folder: TempDir,
    pub(crate) elf: Elf,
}

impl Workbench {
    /// With an image of the build that the native twin reports.
    pub(crate) fn new() -> Self {
        Self::with(Elf::image(SIZE, BUILD_ID, BUILD_IS_DIRTY))
    }

    pub(crate) fn with(elf: Elf) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        fs::create_dir(folder.path().join("bin")).expect("a folder of programs");
        let bench = Self { folder, elf };
        bench.elf.write(&bench.image());
        bench
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub(crate) fn image(&self) -> PathBuf {
        self.path("image.elf")
    }

    /// The option that names the board of the image.
    pub(crate) fn board(&self) -> [&'static str; 2] {
        let board = self.elf.symbols.iter().find_map(|(name, _)| name.strip_prefix("_lashloop_board_"));
        ["--board", board.unwrap_or("unknown")]
    }

    /// The bytes that belong into the flash.
    pub(crate) fn flash(&self) -> &[u8] {
        &self.elf.segments[0].1
    }

    /// Adds a program in the language of the shell. It finds this folder as `$BENCH`.
    pub(crate) fn program(&self, name: &str, script: &str) {
        let path = self.path("bin").join(name);
        fs::write(&path, format!("#!/bin/sh\n{script}\n")).expect("a program");
        fs::set_permissions(&path, Permissions::from_mode(0o755)).expect("an executable program");
    }

    /// Adds a program of the system.
    pub(crate) fn system_program(&self, path: &str) {
        let name = path.rsplit('/').next().expect("a name");
        std::os::unix::fs::symlink(path, self.path("bin").join(name)).expect("a link");
    }

    /// Starts `lashloop flash IMAGE` with these arguments. Only the programs of this folder are in its `PATH`.
    pub(crate) fn start(&self, arguments: &[&str]) -> Running {
        let image = self.image();
        self.start_lashloop(
            [
                &["flash".as_ref(), image.as_os_str()][..],
                &arguments.iter().map(AsRef::as_ref).collect::<Vec<_>>(),
            ]
            .concat(),
        )
    }

    /// Starts `lashloop` with the programs of this folder only.
    pub(crate) fn start_lashloop(&self, arguments: impl IntoIterator<Item = impl Into<OsString>>) -> Running {
        let mut command = Command::new(program::lashloop());
        command.args(arguments.into_iter().map(Into::into));
        command.env("PATH", self.path("bin")).env("BENCH", self.folder.path());
        Running::start_command(command)
    }

    /// Runs `lashloop flash IMAGE` to its end.
    pub(crate) fn flash_with(&self, arguments: &[&str]) -> Ended {
        self.start(arguments).wait()
    }

    /// The command lines that programs have written to `$BENCH/calls`, with the path of this folder as `BENCH`.
    pub(crate) fn calls(&self) -> String {
        let calls = fs::read_to_string(self.path("calls")).unwrap_or_default();
        calls.replace(&self.folder.path().display().to_string(), "BENCH")
    }
}

/// Whether the program claims to have flashed.
pub(crate) fn claims_success(ended: &Ended) -> bool {
    ended.stdout.contains("flashed ")
}

/// Checks that the program's error contains a text.
pub(crate) fn assert_error(ended: &Ended, text: &str) {
    assert!(ended.stderr.contains(text), "{}", ended.stderr);
}
