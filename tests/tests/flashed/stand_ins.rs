//! Programs that stand for probe-rs and dfu-util: they check nothing but record their command lines, and answer as the real
//! ones do according to their manuals.

use std::fs;

use lashloop_firmware::drive::{BUILD_ID, BUILD_IS_DIRTY};
use tests::elf::Elf;
use tests::program::Ended;
use tests::twin::Twin;

use crate::bench::{SIZE, Workbench, assert_error, claims_success};

/// probe-rs with one probe.
const PROBE_RS: &str = r#"
echo "probe-rs $*" >> "$BENCH/calls"
case "$1" in
list) echo "The following debug probes were found:"; echo "[0]: STLink V2-1 -- 0483:374b:0670FF (ST-LINK)";;
esac"#;

/// dfu-util with one chip in its boot loader. An upload yields what was downloaded; its end is an error, as of a chip that
/// leaves the bus. The drive has its port then.
const DFU_UTIL: &str = r#"
echo "dfu-util $*" >> "$BENCH/calls"
case "$*" in
*-l*) echo 'Found DFU: [0483:df11] ver=2200, devnum=9, cfg=1, intf=0, path="1-2", alt=1, name="@Option Bytes  /0x1FFFC000/01*016 e", serial="3276365D3336"'
      echo 'Found DFU: [0483:df11] ver=2200, devnum=9, cfg=1, intf=0, path="1-2", alt=0, name="@Internal Flash  /0x08000000/04*016Kg,01*064Kg,07*128Kg", serial="3276365D3336"';;
*-D*) for file; do :; done; cp "$file" "$BENCH/flash";;
*-U*) for file; do :; done; cp "$BENCH/flash" "$file"; ln -s DRIVE "$BENCH/port"; echo "dfu-util: Error during download get_status" >&2; exit 74;;
esac"#;

fn with_dfu(script: &str, drive: &Twin) -> Workbench {
    let bench = Workbench::new();
    bench.program("dfu-util", &script.replace("DRIVE", &drive.device()));
    bench.system_program("/bin/cp");
    bench.system_program("/bin/ln");
    bench
}

/// Flashes a chip whose drive has a port while its firmware runs.
fn flash_in_loader(bench: &Workbench) -> Ended {
    let port = bench.path("port").display().to_string();
    bench.flash_with(&[&["--device", &port], &bench.board()[..]].concat())
}

/// The drive reported the build of the image before a probe wrote it: a build with changes confirms nothing then.
fn confirmed_after_probe(ended: Ended) -> Ended {
    if BUILD_IS_DIRTY {
        let ended = ended.with_code(1);
        assert!(ended.stderr.contains("not confirmed") && !claims_success(&ended), "{}", ended.stderr);
        return ended;
    }
    let ended = ended.with_code(0);
    assert!(claims_success(&ended), "{}", ended.stdout);
    ended
}

fn flash(bench: &Workbench, twin: &Twin) -> Ended {
    bench.flash_with(&["--device", &twin.device()])
}

pub(crate) fn probe() {
    let (bench, twin) = (Workbench::new(), Twin::start());
    bench.program("probe-rs", PROBE_RS);
    // A probe that was only found may be on another board: the reset stops that one.
    let _ = confirmed_after_probe(flash(&bench, &twin));
    assert!(bench.calls().contains(" --connect-under-reset "), "{}", bench.calls());
    fs::remove_file(bench.path("calls")).expect("the calls");
    let ended = confirmed_after_probe(bench.flash_with(&["--via", "probe", "--device", &twin.device()]));
    assert_eq!(
        bench.calls(),
        "probe-rs list\nprobe-rs download --chip STM32F405RGTx --verify BENCH/image.elf\nprobe-rs reset --chip STM32F405RGTx\n"
    );
    assert!(ended.stdout.contains("native-twin"), "{}", ended.stdout);
    assert!(
        ended.stdout.contains("\nbefore     ") && ended.stdout.contains(", disarmed\n"),
        "{}",
        ended.stdout
    );
    assert!(!ended.stdout.contains("STLink"), "{}", ended.stdout);
}

/// A rig file with a native twin as the drive.
fn rig(bench: &Workbench, twin: &Twin, loader: &str) -> String {
    rig_with(bench, twin, "native-twin", loader)
}

fn rig_with(bench: &Workbench, twin: &Twin, board: &str, loader: &str) -> String {
    let rig = bench.path("rig.toml");
    let device = twin.device();
    let text = format!(
        "title = \"twin\"\ncontact = \"the tester\"\nboard = \"{board}\"\n[port]\ndevice = \"{device}\"\n\
         [limits]\ntorque_nm = 20\nload_travel_rad = 4\n[loader]\n{loader}\n"
    );
    fs::write(&rig, text).expect("a rig file");
    rig.display().to_string()
}

pub(crate) fn probe_of_rig() {
    let (bench, twin) = (Workbench::new(), Twin::start());
    bench.program("probe-rs", PROBE_RS);
    let rig = rig(&bench, &twin, "via = \"probe\"\nchip = \"STM32F407VG\"\nprobe = \"0483:374b:0670FF\"");
    let _ = confirmed_after_probe(bench.flash_with(&["--rig", &rig]));
    let calls = bench.calls();
    let want = "probe-rs download --chip STM32F407VG --probe 0483:374b:0670FF --verify BENCH/image.elf\n";
    assert!(calls.contains(want), "{calls}");
}

pub(crate) fn under_reset() {
    let bench = Workbench::new();
    bench.program("probe-rs", &PROBE_RS.replace("esac", "download) exit 1;;\nesac"));
    let terminal = tests::terminal::open();
    let silent = tests::terminal::device(&terminal);
    for device in [&["--device", &silent][..], &["--device", "tcp:127.0.0.1:1"]] {
        let ended = bench.flash_with(&[&["--via", "probe"], device, &bench.board()].concat()).with_code(4);
        assert!(ended.stdout.contains("the probe connects under reset"), "{}", ended.stdout);
    }
    let want = "probe-rs list\nprobe-rs download --chip STM32F405RGTx --connect-under-reset --verify BENCH/image.elf\n";
    assert_eq!(bench.calls(), want.repeat(2));
}

pub(crate) fn other_board() {
    let mut elf = Elf::image(SIZE, BUILD_ID, BUILD_IS_DIRTY);
    elf.symbols[2].0 = "_lashloop_board_odrive-v3";
    let (bench, twin) = (Workbench::with(elf), Twin::start());
    bench.program("probe-rs", PROBE_RS);
    let message = flash(&bench, &twin).with_code(2).stderr;
    assert!(message.contains("is for the board odrive-v3, and that of the drive on "), "{message}");
    let rig = rig(&bench, &twin, "");
    let message = bench.flash_with(&["--rig", &rig]).with_code(2).stderr;
    assert!(message.contains("rig.toml is native-twin: the pins differ"), "{message}");
    assert_eq!(bench.calls(), "probe-rs list\n", "something was written");
    // A drive with the wrong image takes the right one, because the rig file has the board.
    let rig = rig_with(&bench, &twin, "odrive-v3", "");
    let ended = bench.flash_with(&["--rig", &rig]).with_code(1);
    assert_error(&ended, "reports the board native-twin");
    assert!(bench.calls().contains("probe-rs download") && !claims_success(&ended), "{}", ended.stdout);
}

pub(crate) fn no_build() {
    for (lacks, code, message) in [(0, 1, "has no build to compare with"), (2, 2, "does not name its board")]
    {
        let mut elf = Elf::image(SIZE, BUILD_ID, BUILD_IS_DIRTY);
        let _ = elf.symbols.remove(lacks);
        let (bench, twin) = (Workbench::with(elf), Twin::start());
        bench.program("probe-rs", PROBE_RS);
        let ended = flash(&bench, &twin).with_code(code);
        assert!(ended.stderr.contains(message), "{}", ended.stderr);
        assert_eq!(bench.calls(), "", "something was written");
    }
}

/// The probe has written another chip than that of the drive.
pub(crate) fn other_build() {
    let (bench, twin) = (Workbench::with(Elf::image(SIZE, BUILD_ID ^ 1, BUILD_IS_DIRTY)), Twin::start());
    bench.program("probe-rs", PROBE_RS);
    let ended = flash(&bench, &twin).with_code(1);
    let [drive, image] = [BUILD_ID, BUILD_ID ^ 1].map(|build| format!("build {build:08x}"));
    assert!(ended.stderr.contains(&drive) && ended.stderr.contains(&image), "{}", ended.stderr);
    assert!(!claims_success(&ended), "{}", ended.stdout);
}

pub(crate) fn simulator() {
    let bench = Workbench::new();
    bench.program("probe-rs", PROBE_RS);
    for device in ["native", "inproc", "qemu"] {
        let message = bench.flash_with(&["--device", device]).with_code(2).stderr;
        assert!(message.contains(&format!("{device} is a simulator, which no loader reaches")), "{message}");
    }
    assert_eq!(bench.calls(), "", "something was written");
}

pub(crate) fn two_probes() {
    let (bench, twin) = (Workbench::new(), Twin::start());
    bench.program("probe-rs", "echo \"[0]: A\"; echo \"[1]: B\"; echo \"probe-rs $*\" >> \"$BENCH/calls\"");
    let ended = bench.flash_with(&["--via", "probe", "--device", &twin.device()]).with_code(4);
    assert_error(&ended, "finds 2 debug probes");
    assert_eq!(bench.calls(), "probe-rs list\n", "something was written");
}

pub(crate) fn dfu() {
    let twin = Twin::start();
    let bench = with_dfu(DFU_UTIL, &twin);
    let ended = flash_in_loader(&bench).with_code(0);
    assert!(claims_success(&ended), "{}", ended.stdout);
    assert!(
        fs::read(bench.path("flash")).expect("a flash") == bench.flash(),
        "the flash differs from the image"
    );
    let calls = bench.calls();
    let calls: Vec<_> = calls.lines().map(|call| call.rsplit_once(' ').expect("arguments").0).collect();
    let read = format!("dfu-util -a 0 -d 0483:df11 -s 0x08000000:{SIZE}:leave -U");
    assert_eq!(calls, ["dfu-util -l -d", "dfu-util -a 0 -d 0483:df11 -s 0x08000000 -D", &read]);
}

/// The chip in its loader is on another board than the drive.
pub(crate) fn another_chip() {
    let twin = Twin::start();
    let bench = with_dfu(DFU_UTIL, &twin);
    let ended = flash(&bench, &twin).with_code(4);
    assert_error(&ended, "the chip that dfu-util finds in its boot loader is another one");
    assert!(!bench.path("flash").exists() && !claims_success(&ended), "{}", bench.calls());
}

/// No serial port on USB is on a machine that builds this.
pub(crate) fn no_port() {
    let bench = with_dfu(DFU_UTIL, &Twin::start());
    let ended = bench.flash_with(&[&["--via", "dfu"], &bench.board()[..]].concat()).with_code(4);
    assert_error(&ended, "written and compared, but not confirmed");
    assert!(ended.stdout.contains("\nwritten    ") && !claims_success(&ended), "{}", ended.stdout);
}

/// A chip without a drive takes the image of a board that the user names.
pub(crate) fn blank_chip() {
    let bench = with_dfu(DFU_UTIL, &Twin::start());
    let ended = bench.flash_with(&["--via", "dfu"]).with_code(2);
    assert_error(&ended, "call again with --board native-twin");
    let ended = bench.flash_with(&["--via", "dfu", "--board", "odrive-v3"]).with_code(2);
    assert_error(&ended, "is for the board native-twin, and that of --board is odrive-v3");
    assert!(!bench.path("flash").exists() && !claims_success(&ended), "{}", bench.calls());
}

/// A killed bench leaves no program behind that writes.
pub(crate) fn killed() {
    let (bench, twin) = (Workbench::new(), Twin::start());
    let script =
        PROBE_RS.replace("esac", "download) echo $$ > \"$BENCH/writing\"; exec /bin/sleep 600;;\nesac");
    bench.program("probe-rs", &script);
    let flash = bench.start(&["--device", &twin.device()]);
    let loader = tests::wait::until("the program writes", || {
        fs::read_to_string(bench.path("writing")).ok()?.trim().parse::<u32>().ok()
    });
    flash.signal(rustix::process::Signal::KILL);
    tests::wait::until("the program ends with the bench", || (!tests::processes::runs(loader)).then_some(()));
}

pub(crate) fn dfu_different() {
    let damaged = DFU_UTIL.replace(r#"cp "$file" "$BENCH/flash""#, r#"cp "$BENCH/image.elf" "$BENCH/flash""#);
    let twin = Twin::start();
    let ended = flash_in_loader(&with_dfu(&damaged, &twin)).with_code(4);
    // The ELF begins with 0x7f, the image with the low byte of its stack.
    assert_error(&ended, "the byte at 0x08000000 reads back as 0x7f, 0x00 was written");
    assert!(ended.stderr.contains("hold BOOT0 high") && !claims_success(&ended), "{}", ended.stderr);
}

/// The flash has the image, and the drive reports its build: that may be from before.
fn assert_not_flashed(ended: Ended, program: &str) {
    let ended = ended.with_code(4);
    assert!(ended.stderr.contains(&format!("not flashed: {program} failed")), "{}", ended.stderr);
    assert!(ended.stderr.contains("call again") && !claims_success(&ended), "{}", ended.stdout);
}

pub(crate) fn download_failed() {
    let fails = DFU_UTIL.replace(r#"cp "$file" "$BENCH/flash""#, r#"cp "$file" "$BENCH/flash"; exit 74"#);
    let twin = Twin::start();
    assert_not_flashed(flash_in_loader(&with_dfu(&fails, &twin)), "dfu-util");
}

pub(crate) fn reset_failed() {
    let (bench, twin) = (Workbench::new(), Twin::start());
    bench.program("probe-rs", &PROBE_RS.replace("esac", "reset) exit 1;;\nesac"));
    assert_not_flashed(flash(&bench, &twin), "probe-rs");
}

pub(crate) fn failed() {
    let (bench, twin) = (Workbench::new(), Twin::start());
    let script =
        PROBE_RS.replace("esac", "download) printf '\\033[31mError\\033[0m\\nno ACK\\n' >&2; exit 1;;\nesac");
    bench.program("probe-rs", &script);
    let ended = flash(&bench, &twin).with_code(4);
    let message = &ended.stderr;
    assert!(
        message.contains(r"\u{1b}[31mError\u{1b}[0m; no ACK") && !message.contains('\u{1b}'),
        "{message}"
    );
    assert!(message.contains("connect the probe and call again") && !claims_success(&ended), "{message}");
}

pub(crate) fn no_way() {
    let (bench, twin) = (Workbench::new(), Twin::start());
    bench.program("dfu-util", "echo 'dfu-util 0.11'");
    let message = flash(&bench, &twin).with_code(4).stderr;
    for reason in [
        "probe  probe-rs is not installed: install it from https://probe.rs",
        "dfu    no chip on USB is in its boot loader: hold BOOT0 high during a reset",
        "uart   ",
        "stm32flash is not installed: install the package stm32flash",
    ] {
        assert!(message.contains(reason), "{reason}: {message}");
    }
}

pub(crate) fn rig_in_use() {
    let (bench, twin) = (Workbench::with(Elf::image(SIZE, 1, false)), Twin::start());
    let rig = rig(&bench, &twin, "");
    bench.program("probe-rs", "echo $$ > \"$BENCH/started\"; exec /bin/sleep 60");
    let first = bench.start(&["--rig", &rig]);
    tests::wait::until("the first program looks for a probe", || {
        bench.path("started").exists().then_some(())
    });
    // A port without a rig file is the same rig.
    for second in [["--rig", &rig], ["--device", &twin.device()]] {
        let ended = bench.flash_with(&second).with_code(4);
        let holder = format!("the rig is in use by process {} of ", first.id());
        assert_error(&ended, &holder);
        assert_error(&ended, "lashloop flash");
    }
    first.signal(rustix::process::Signal::INT);
    let _ = first.wait();
}

pub(crate) fn run_in_progress() {
    let (bench, twin) = (Workbench::new(), Twin::start());
    bench.program("probe-rs", PROBE_RS);
    let (run, _records) = tests::loss::run_in_progress(&twin.device());
    bench.program("stm32flash", "echo \"stm32flash $*\" >> \"$BENCH/calls\"");
    for via in [&[][..], &["--via", "uart"]] {
        let message = bench.flash_with(&[&["--device", &twin.device()], via].concat()).with_code(4).stderr;
        assert!(message.contains("another program holds it"), "{message}");
        assert_eq!(bench.calls(), "", "a program reached for a running drive");
    }
    run.signal(rustix::process::Signal::INT);
    let _ = run.wait().with_code(3);
}
