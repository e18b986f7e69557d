//! The image conforms to the protocol.

use tests::battery::{LASHLOOP_SKIPS, all_passed, conformance};

pub(crate) fn every_check() {
    let ended = conformance("qemu", &[]);
    assert!(ended.stdout.starts_with("qemu (stm32f405"), "{}", ended.stdout);
    all_passed(&ended.stdout, LASHLOOP_SKIPS);
}
