//! Runs with the emulated board.

use tests::paper::{PaperRun, check_link};
use tests::program;
use tests::records::Records;

/// The emulated processor gives the paper's number and the pinned torque digest.
pub(crate) fn same_as_in_process(run: PaperRun) {
    let emulated = run.pass_on("qemu");
    let in_process = run.pass_on("inproc");
    for key in ["torque_sha256", "metrics", "steps", "expectations"] {
        assert_eq!(emulated[key], in_process[key], "{}: {key}", run.name);
    }
    check_link(&emulated, run.name);
}

pub(crate) fn identity() {
    let records = Records::new();
    let arguments = ["run", "scenarios/smooth-after.toml", "--device", "qemu", "--out", &records.out()];
    // The load can't settle in ten steps, so the verdict is FAIL.
    let _ = program::run(arguments.into_iter().chain(["--set", "run.duration_s=0.01"])).with_code(1);
    let summary = records.summary();
    let device = summary["device"].as_str().expect("the device");
    assert!(device.starts_with("qemu (stm32f405-qemu, firmware "), "{device}");
    assert_eq!(summary["versions"]["firmware"], summary["versions"]["lashloop"]);
}

pub(crate) fn no_image() {
    let ended =
        program::run(["run", "scenarios/smooth-after.toml", "--device", "qemu:no/such.elf"]).with_code(4);
    let want = "lashloop: no image of the firmware at no/such.elf: build it with `cargo xtask image`, or name it by \
                qemu:PATH or LASHLOOP_IMAGE\n";
    assert_eq!((ended.stderr.as_str(), ended.stdout.as_str()), (want, ""));
}

/// A file that QEMU loads as a program and that locks up the processor at once: its first function is at no memory, and so is
/// the handler of that fault.
pub(crate) fn stranger() {
    let records = Records::new();
    let image = records.path("zeros.bin");
    let vectors = [0x2000_1000_u32, 0x0fff_ffff].map(u32::to_le_bytes).concat();
    std::fs::write(&image, [&vectors[..], &[0; 1016]].concat()).expect("an image of the test");
    let device = format!("qemu:{}", image.display());
    let ended = program::run(["run", "scenarios/smooth-after.toml", "--device", &device]).with_code(4);
    assert_eq!(ended.stderr.lines().count(), 1, "{}", ended.stderr);
    let side =
        format!("lashloop: the drive side ended during the session with {device}: the emulator (process ");
    assert!(ended.stderr.starts_with(&side), "{}", ended.stderr);
    // The cause that QEMU reports, not the end of the register dump that follows.
    assert!(ended.stderr.contains("qemu: fatal: Lockup"), "{}", ended.stderr);
    assert!(ended.stderr.contains("no sample sent yet, no good frame received"), "{}", ended.stderr);
}
