//! The real stm32flash against a boot loader on a pseudo-terminal, and `lashloop flash` around it. After `Go` nothing answers here:
//! the tests of virtual silicon start what a loader has received.

use std::fs::File;

use lashloop_bench::supervisor::find_program;
use lashloop_firmware::drive::{BUILD_ID, BUILD_IS_DIRTY, Drive};
use rustix::process::Signal;
use tests::elf::Elf;
use tests::powered::Powered;
use tests::program::{Ended, Running};
use tests::rom_loader::{Defect, FLASH, PROGRAM, RomLoader, serve};
use tests::terminal::{self, Terminal};
use tests::twin::Twin;
use tests::{processes, wait};

use crate::bench::{SIZE, Workbench, assert_error, claims_success};

/// End of the last sector that the image touches.
const ERASED_END: usize = 1 << 15;

fn with(elf: Elf) -> Workbench {
    let bench = Workbench::with(elf);
    let program = find_program(PROGRAM).expect("stm32flash");
    bench.system_program(&program.display().to_string());
    bench
}

fn right() -> Workbench {
    with(Elf::image(SIZE, BUILD_ID, BUILD_IS_DIRTY))
}

/// A board whose line is a pseudo-terminal.
struct Board {
    terminal: Terminal,
    /// What runs until the loader is entered.
    drive: Option<Powered>,
    loader: RomLoader,
}

impl Board {
    fn in_loader(defect: Defect) -> Self {
        Self { terminal: terminal::open(), drive: None, loader: RomLoader::new(defect) }
    }

    fn with_drive() -> Self {
        let drive = Powered::from(Drive::new("native-twin").with_loader());
        Self { drive: Some(drive), ..Self::in_loader(Defect::None) }
    }

    fn device(&self) -> String {
        terminal::device(&self.terminal)
    }

    /// Serves a program until it has ended, or until nothing answers any longer.
    fn serve(&mut self, program: &mut Running) {
        let mut line = File::from(self.terminal.far_end.try_clone().expect("a handle"));
        serve(&mut line, program, |bytes| {
            self.drive.take_if(|drive| drive.enters_loader());
            match &mut self.drive {
                Some(drive) => Some(drive.exchange(bytes)),
                None if self.loader.hangs() || self.loader.left_for.is_some() => None,
                None => Some(self.loader.exchange(bytes)),
            }
        });
    }

    fn flash(&mut self, bench: &Workbench, arguments: &[&str]) -> Ended {
        let mut running = bench.start(arguments);
        self.serve(&mut running);
        running.wait()
    }

    fn is_untouched(&self) -> bool {
        self.loader.flash.iter().all(|byte| *byte == 0)
    }

    /// Checks that the image alone was written and started, and that nothing confirms it.
    fn assert_written(&self, bench: &Workbench, ended: Ended) {
        let ended = ended.with_code(4);
        let flash = &self.loader.flash;
        assert!(flash[..SIZE] == *bench.flash(), "the flash differs from the image");
        let is_all = |rest: &[u8], value: u8| rest.iter().all(|byte| *byte == value);
        assert!(is_all(&flash[SIZE..ERASED_END], 0xff), "a byte after the image is written");
        assert!(is_all(&flash[ERASED_END..], 0), "a sector after the image is erased");
        assert_eq!(self.loader.left_for, Some(FLASH));
        assert!(ended.stdout.contains("\nway        uart: ") && !claims_success(&ended), "{}", ended.stdout);
        assert_error(&ended, "written and compared, but not confirmed");
        assert_error(&ended, "hold BOOT0 high during a reset and call again");
        assert_eq!(ended.stderr.lines().count(), 1, "output of stm32flash on the terminal: {}", ended.stderr);
    }
}

pub(crate) fn written() {
    let (bench, mut board) = (right(), Board::in_loader(Defect::None));
    let ended = board.flash(&bench, &[&["--device", &board.device()], &bench.board()[..]].concat());
    board.assert_written(&bench, ended);
}

pub(crate) fn another_chip() {
    let (bench, mut board, twin) = (right(), Board::in_loader(Defect::None), Twin::start());
    let port = board.device();
    let ended = board.flash(&bench, &["--device", &twin.device(), "--loader-port", &port]).with_code(4);
    assert_error(&ended, "the chip that stm32flash finds in its boot loader");
    assert!(board.is_untouched(), "something was written");
}

pub(crate) fn by_request() {
    let (bench, mut board) = (right(), Board::with_drive());
    let port = board.device();
    let ended = board.flash(&bench, &["--device", &port, "--loader-port", &port]);
    let before = ended.stdout.lines().find(|line| line.starts_with("before ")).unwrap_or_default();
    assert!(before.contains("native-twin") && before.ends_with("enters its boot loader"), "{}", ended.stdout);
    board.assert_written(&bench, ended);
}

pub(crate) fn no_request() {
    let (bench, mut board) = (right(), Board::with_drive());
    let ended = board.flash(&bench, &["--via", "uart", "--device", &board.device()]).with_code(4);
    assert!(!ended.stdout.contains("enters"), "{}", ended.stdout);
    assert!(board.drive.is_some(), "the firmware has ended");
}

pub(crate) fn no_request_for_other_board() {
    let mut elf = Elf::image(SIZE, BUILD_ID, BUILD_IS_DIRTY);
    elf.symbols[2].0 = "_lashloop_board_stm32f405";
    let mut board = Board::with_drive();
    let port = board.device();
    let port = ["--via", "uart", "--device", &port, "--loader-port", &port];
    let ended = board.flash(&with(elf), &port).with_code(2);
    assert_error(&ended, "is for the board stm32f405");
    assert!(!ended.stdout.contains("enters"), "{}", ended.stdout);
    assert!(board.drive.is_some() && board.is_untouched(), "the firmware has ended");
}

pub(crate) fn unreached() {
    let (bench, mut board, elsewhere) = (right(), Board::with_drive(), terminal::open());
    let ports = ["--device", &board.device(), "--loader-port", &terminal::device(&elsewhere)];
    let ended = board.flash(&bench, &[&["--via", "uart"], &ports[..]].concat()).with_code(4);
    assert_error(&ended, "the drive is in its boot loader, and no way leads there; reset the board");
    assert!(!claims_success(&ended), "{}", ended.stdout);
}

pub(crate) fn not_taken() {
    // A byte whose lowest bit is 1 in the image.
    let odd = right().flash().iter().rposition(|byte| byte & 1 == 1).expect("an odd byte");
    for defect in [Defect::Protected, Defect::Garbled, Defect::Hangs, Defect::StuckBit(odd)] {
        let (bench, mut board) = (right(), Board::in_loader(defect));
        let port = board.device();
        let ended =
            board.flash(&bench, &[&["--via", "uart", "--device", &port], &bench.board()[..]].concat());
        let ended = ended.with_code(4);
        assert!(ended.stderr.contains("not flashed: stm32flash failed"), "{defect:?}: {}", ended.stderr);
        assert_error(&ended, "hold BOOT0 high during a reset and call again");
        assert!(board.loader.left_for.is_none() && !claims_success(&ended), "{}", ended.stdout);
    }
}

pub(crate) fn interrupted() {
    let (bench, mut board) = (right(), Board::in_loader(Defect::Hangs));
    let port = board.device();
    let mut running = bench.start(&[&["--via", "uart", "--device", &port], &bench.board()[..]].concat());
    board.serve(&mut running);
    let only_child = |of: u32| {
        let [child] = processes::children(of)[..] else { panic!("one child was expected") };
        child
    };
    // Under its guard.
    let stm32flash = only_child(only_child(running.id()));
    assert_eq!(processes::name(stm32flash), PROGRAM);
    running.signal(Signal::INT);
    let ended = running.wait().with_code(3);
    // The kernel may take a moment to end what has been killed.
    wait::until("the end of stm32flash", || (!processes::runs(stm32flash)).then_some(()));
    assert_error(&ended, "interrupted; the flash may be incomplete; hold BOOT0");
    assert!(!claims_success(&ended), "{}", ended.stdout);
}

pub(crate) fn no_loader() {
    let (bench, twin) = (right(), Twin::start());
    let port = twin.device();
    let ended = bench.flash_with(&["--via", "uart", "--device", &port, "--loader-port", &port]).with_code(4);
    assert!(ended.stdout.contains("enters no boot loader: "), "{}", ended.stdout);
    assert_error(&ended, "no boot loader answers");
    assert_error(&ended, "BOOT0");
}
