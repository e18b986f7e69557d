//! It keeps to the protocol.

use tests::bench::run;
use tests::python;

pub(crate) fn every_check() {
    let drive = python::drive();
    let ended = run(["conformance", "--device", &drive.device()]).with_code(0);
    assert!(ended.stdout.starts_with(&format!("{} (python, firmware ", drive.device())), "{}", ended.stdout);
    assert!(ended.stdout.ends_with(" passed, 0 failed, 0 skipped\n"), "{}", ended.stdout);
}
