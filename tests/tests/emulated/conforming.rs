//! The image conforms to the protocol.

use tests::battery::{LASHLOOP_SKIPS, all_passed};
use tests::program::run;

pub(crate) fn every_check() {
    let ended = run(["conformance", "--device", "qemu"]).with_code(0);
    assert!(ended.stdout.starts_with("qemu (stm32f405"), "{}", ended.stdout);
    all_passed(&ended.stdout, LASHLOOP_SKIPS);
}
