//! The Python drive conforms to the protocol.

use tests::battery::{NOTHING_CAPTURED, NOTHING_STORED, PD_ALONE_SKIPS, all_passed};
use tests::program::run;
use tests::python;

/// A drive of the package with everything that a drive without pins may describe, so that no other check is omitted.
pub(crate) fn every_check() {
    let device = python::on_standard_streams("clients/python/tests/drive_for_conformance.py");
    let ended = run(["conformance", "--device", &device]).with_code(0);
    assert!(ended.stdout.starts_with(&format!("{device} (python, firmware ")), "{}", ended.stdout);
    all_passed(&ended.stdout, &["the drive has no bench mode", NOTHING_STORED, NOTHING_CAPTURED]);
}

/// `python -m lashloop drive` on a pseudo-terminal. It has one law, and fewer signals than a telemetry holds.
pub(crate) fn the_package_s_own() {
    let drive = python::drive();
    let ended = run(["conformance", "--device", &drive.device()]).with_code(0);
    all_passed(&ended.stdout, PD_ALONE_SKIPS);
}
