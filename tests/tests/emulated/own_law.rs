//! The image of `examples/own-law`: a law from a crate of its own on the board.

use tests::paper::PATIENCE;
use tests::program;
use tests::records::Records;

const IMAGE: &str = "qemu:target/own-law-image.elf";

pub(crate) fn equal_torques() {
    let [image, twin, process] = [IMAGE, "native", "inproc"].map(|device| {
        let records = Records::new();
        let arguments = ["run", "examples/own-law/own-law.toml", "--device", device, "--out", &records.out()];
        let _ = program::run_example("own-law", arguments.into_iter().chain(PATIENCE)).with_code(0);
        let summary = records.summary();
        assert_eq!(summary["controller"], "velocity-pi", "{device}");
        (["torque_sha256", "metrics", "steps"].map(|key| summary[key].clone()), records.trace())
    });
    assert_eq!(image.0, process.0, "image and process");
    assert_eq!(twin.0, process.0, "twin and process");
    let signal = "drive.wanted_twist_rad";
    assert_eq!(image.1.column(signal), process.1.column(signal));
}

/// `lashloop` itself tests the image: it takes laws and signals as the drive describes them.
pub(crate) fn conforming() {
    let ended = program::run(["conformance", "--device", IMAGE]).with_code(0);
    assert!(ended.stdout.contains(" passed, 0 failed, "), "{}", ended.stdout);
    let listed = program::run(["parameters", "list", "--device", IMAGE]).with_code(0);
    assert!(listed.stdout.contains("velocity_integral_nm_rad"), "{}", listed.stdout);
}
