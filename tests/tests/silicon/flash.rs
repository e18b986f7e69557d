//! `lashloop flash` on a running image, which enters its boot loader. What the loader has received then runs on virtual silicon.

use std::fs::File;
use std::io::Read;
use std::path::Path;
use std::process::{Child, Command, Stdio};

use tests::elf::Elf;
use tests::program::Running;
use tests::rom_loader::{Defect, FLASH, RomLoader, serve};
use tests::terminal::{self, Terminal};
use tests::wait;

use crate::equipment;

/// An image at the far end of a terminal. Dropping it ends the process.
struct Chip(Child);

impl Chip {
    fn start(image: &Path, terminal: &Terminal) -> Self {
        let far_end = || Stdio::from(terminal.far_end.try_clone().expect("a handle"));
        let mut silicon = Command::new(equipment::program());
        silicon.arg(image).stdin(far_end()).stdout(far_end()).stderr(Stdio::piped());
        Self(silicon.spawn().expect("lashloop-silicon starts"))
    }

    /// Waits until the image maps the ROM, which virtual silicon doesn't serve.
    fn await_rom(&mut self) {
        let ended = wait::until("the entry into the ROM", || self.0.try_wait().expect("a process"));
        let mut report = String::new();
        self.0.stderr.take().expect("a pipe").read_to_string(&mut report).expect("a report");
        assert_eq!(ended.code(), Some(1), "{report}");
        assert!(report.contains("SYSCFG.MEMRM"), "{report}");
    }
}

impl Drop for Chip {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

pub(crate) fn received() {
    let terminal = terminal::open();
    let port = terminal::device(&terminal);
    let mut before = Chip::start(&equipment::image(), &terminal);
    let image = equipment::image().display().to_string();
    let mut flash =
        Running::start(["flash", &image, "--via", "uart", "--device", &port, "--loader-port", &port]);
    before.await_rom();
    let mut loader = RomLoader::new(Defect::None);
    let mut line = File::from(terminal.far_end.try_clone().expect("a handle"));
    serve(&mut line, &mut flash, |bytes| loader.left_for.is_none().then(|| loader.exchange(bytes)));
    assert_eq!(loader.left_for, Some(FLASH));
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("received.elf");
    Elf { machine: 40, segments: vec![(FLASH, loader.flash)], symbols: Vec::new() }.write(&path);
    let _received = Chip::start(&path, &terminal);
    let ended = flash.wait().with_code(0);
    let report = format!("flashed    the drive on {port} reports stm32f405, firmware ");
    assert!(ended.stdout.lines().any(|line| line.starts_with(&report)), "{}", ended.stdout);
}
