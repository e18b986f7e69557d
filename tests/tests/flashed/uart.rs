//! The real stm32flash against a chip in its boot loader on a pseudo-terminal.

use std::env;

use lashloop_firmware::drive::{BUILD_ID, BUILD_IS_DIRTY};
use rustix::process::Signal;
use tests::elf::Elf;
use tests::program::Ended;
use tests::rom_loader::{Defect, RomLoader};
use tests::twin::Twin;
use tests::{processes, terminal, wait};

use crate::bench::{SIZE, Workbench, claims_success};

const PROGRAM: &str = "stm32flash";

fn program() -> Option<String> {
    let path = env::var_os("PATH").unwrap_or_default();
    let found = env::split_paths(&path).map(|folder| folder.join(PROGRAM)).find(|path| path.is_file());
    found.map(|path| path.display().to_string())
}

/// Names missing equipment and the command that installs it.
pub(crate) fn missing() -> Option<String> {
    program().is_none().then(|| format!("{PROGRAM} is not installed: run `cargo xtask setup`"))
}

fn with(elf: Elf) -> Workbench {
    let bench = Workbench::with(elf);
    bench.system_program(&program().expect("stm32flash"));
    bench
}

fn right() -> Workbench {
    with(Elf::image(SIZE, BUILD_ID, BUILD_IS_DIRTY))
}

fn flash(bench: &Workbench, loader: &RomLoader) -> Ended {
    bench.flash_with(&[&["--via", "uart", "--device", &loader.device], &bench.board()[..]].concat())
}

pub(crate) fn flashed() {
    let (bench, loader) = (right(), RomLoader::start(Defect::None));
    let ended = flash(&bench, &loader).with_code(0);
    assert!(loader.flash(SIZE) == bench.flash(), "the flash differs from the image");
    assert_eq!(loader.flash(SIZE + 1)[SIZE], 0xff, "a byte after the image is written");
    let last = ended.stdout.lines().last().unwrap_or_default();
    let report = format!("flashed    the drive on {} reports native-twin, firmware ", loader.device);
    assert!(last.starts_with(&report) && last.contains(&format!("{BUILD_ID:08x}")), "{}", ended.stdout);
    assert_eq!(ended.stderr, "", "output of stm32flash on the terminal");
}

pub(crate) fn found() {
    let (bench, loader) = (right(), RomLoader::start(Defect::None));
    let ended = bench.flash_with(&[&["--device", &loader.device], &bench.board()[..]].concat()).with_code(0);
    assert!(ended.stdout.contains("\nway        uart: "), "{}", ended.stdout);
}

pub(crate) fn another_chip() {
    let (bench, loader, twin) = (right(), RomLoader::start(Defect::None), Twin::start());
    let ended = bench.flash_with(&["--device", &twin.device(), "--loader-port", &loader.device]).with_code(4);
    assert!(ended.stderr.contains("the chip that stm32flash finds in its boot loader"), "{}", ended.stderr);
    assert!(loader.flash(SIZE).iter().all(|byte| *byte == 0xff), "something was written");
}

pub(crate) fn by_request() {
    for via in [&["--via", "uart"][..], &[]] {
        let (bench, chip) = (right(), RomLoader::behind_a_drive());
        let port = ["--device", &chip.device, "--loader-port", &chip.device];
        let ended = bench.flash_with(&[via, &port].concat()).with_code(0);
        assert!(chip.flash(SIZE) == bench.flash(), "the flash differs from the image");
        let before = ended.stdout.lines().find(|line| line.starts_with("before ")).unwrap_or_default();
        assert!(
            before.contains("native-twin") && before.ends_with("enters its boot loader"),
            "{}",
            ended.stdout
        );
        assert!(claims_success(&ended), "{}", ended.stdout);
    }
}

pub(crate) fn no_request() {
    let (bench, chip) = (right(), RomLoader::behind_a_drive());
    let ended = bench.flash_with(&["--via", "uart", "--device", &chip.device]).with_code(4);
    assert!(!ended.stdout.contains("enters"), "{}", ended.stdout);
    // It still runs its firmware.
    let doctor = tests::program::run(["doctor", &chip.device]);
    assert!(doctor.stdout.contains("native-twin"), "{}{}", doctor.stdout, doctor.stderr);
}

pub(crate) fn no_request_for_other_board() {
    let mut elf = Elf::image(SIZE, BUILD_ID, BUILD_IS_DIRTY);
    elf.symbols[2].0 = "_lashloop_board_stm32f405";
    let chip = RomLoader::behind_a_drive();
    let port = ["--via", "uart", "--device", &chip.device, "--loader-port", &chip.device];
    let ended = with(elf).flash_with(&port).with_code(2);
    assert!(ended.stderr.contains("is for the board stm32f405"), "{}", ended.stderr);
    assert!(!ended.stdout.contains("enters"), "{}", ended.stdout);
    assert!(chip.flash(SIZE).iter().all(|byte| *byte == 0xff), "something was written");
}

pub(crate) fn unreached() {
    let (bench, chip, elsewhere) = (right(), RomLoader::behind_a_drive(), terminal::open());
    let port = terminal::device(&elsewhere);
    let ended =
        bench.flash_with(&["--via", "uart", "--device", &chip.device, "--loader-port", &port]).with_code(4);
    assert!(
        ended.stderr.contains("the drive is in its boot loader, and no way leads there; reset the board"),
        "{}",
        ended.stderr
    );
    assert!(!claims_success(&ended), "{}", ended.stdout);
}

pub(crate) fn other_build() {
    let (bench, loader) =
        (with(Elf::image(SIZE, BUILD_ID ^ 1, BUILD_IS_DIRTY)), RomLoader::start(Defect::None));
    let ended = flash(&bench, &loader).with_code(1);
    assert!(loader.flash(SIZE) == bench.flash(), "the flash differs from the image");
    let [drive, image] = [BUILD_ID, BUILD_ID ^ 1].map(|build| format!("build {build:08x}"));
    assert!(ended.stderr.contains(&drive) && ended.stderr.contains(&image), "{}", ended.stderr);
    assert!(!claims_success(&ended), "{}", ended.stdout);
}

pub(crate) fn other_board() {
    let mut elf = Elf::image(SIZE, BUILD_ID, BUILD_IS_DIRTY);
    elf.symbols[2].0 = "_lashloop_board_stm32f405";
    let ended = flash(&with(elf), &RomLoader::start(Defect::None)).with_code(1);
    assert!(
        ended.stderr.contains("reports the board native-twin, and the image is for stm32f405"),
        "{}",
        ended.stderr
    );
    assert!(!claims_success(&ended), "{}", ended.stdout);
}

pub(crate) fn no_build() {
    for (lacks, code, message) in [(0, 1, "has no build to compare with"), (2, 2, "does not name its board")]
    {
        let mut elf = Elf::image(SIZE, BUILD_ID, BUILD_IS_DIRTY);
        let _ = elf.symbols.remove(lacks);
        let loader = RomLoader::start(Defect::None);
        let ended = flash(&with(elf), &loader).with_code(code);
        assert!(ended.stderr.contains(message), "{}", ended.stderr);
        assert!(loader.flash(SIZE).iter().all(|byte| *byte == 0xff), "something was written");
        assert!(!claims_success(&ended), "{}", ended.stdout);
    }
}

fn failed(defect: Defect) -> String {
    let (bench, loader) = (right(), RomLoader::start(defect));
    let ended = flash(&bench, &loader).with_code(4);
    assert!(!claims_success(&ended), "{}", ended.stdout);
    assert!(ended.stderr.contains("hold BOOT0 high during a reset and call again"), "{}", ended.stderr);
    ended.stderr
}

pub(crate) fn protected() {
    let message = failed(Defect::Protected);
    assert!(message.contains("not flashed: stm32flash failed"), "{message}");
}

pub(crate) fn stuck_bit() {
    // A byte whose lowest bit is 1 in the image.
    let bench = right();
    let at = bench.flash().iter().rposition(|byte| byte & 1 == 1).expect("an odd byte");
    let message = failed(Defect::StuckBit(at));
    assert!(message.contains("not flashed: stm32flash failed"), "{message}");
}

pub(crate) fn interrupted() {
    let (bench, loader) = (right(), RomLoader::start(Defect::Hangs));
    let running = bench.start(&[&["--via", "uart", "--device", &loader.device], &bench.board()[..]].concat());
    wait::until("the first write", || loader.hangs().then_some(()));
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
    assert!(
        ended.stderr.contains("interrupted; the flash may be incomplete; hold BOOT0"),
        "{}",
        ended.stderr
    );
    assert!(!claims_success(&ended), "{}", ended.stdout);
}

pub(crate) fn silent() {
    let message = failed(Defect::Silent);
    assert!(message.contains("written and compared, but not confirmed"), "{message}");
}

pub(crate) fn no_loader() {
    let (bench, twin) = (right(), Twin::start());
    let port = twin.device();
    let ended = bench.flash_with(&["--via", "uart", "--device", &port, "--loader-port", &port]).with_code(4);
    assert!(ended.stdout.contains("enters no boot loader: "), "{}", ended.stdout);
    assert!(
        ended.stderr.contains("no boot loader answers") && ended.stderr.contains("BOOT0"),
        "{}",
        ended.stderr
    );
}
