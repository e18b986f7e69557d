//! The image keeps to the protocol.

use tests::bench::run;

pub(crate) fn every_check() {
    let ended = run(["conformance", "--device", "qemu"]).with_code(0);
    assert!(ended.stdout.starts_with("qemu (stm32f405"), "{}", ended.stdout);
    assert!(ended.stdout.ends_with(" passed, 0 failed, 0 skipped\n"), "{}", ended.stdout);
}
