//! The image conforms to the protocol.

use tests::program::run;

pub(crate) fn every_check() {
    let ended = run(["conformance", "--device", "qemu"]).with_code(0);
    assert!(ended.stdout.starts_with("qemu (stm32f405"), "{}", ended.stdout);
    // The drive has no 14 signals, and all of its laws have the same.
    assert!(ended.stdout.ends_with(" passed, 0 failed, 2 skipped\n"), "{}", ended.stdout);
    let skipped = ended.stdout.lines().filter(|line| line.starts_with("SKIPPED  telemetry: ")).count();
    assert_eq!(skipped, 2, "{}", ended.stdout);
}
