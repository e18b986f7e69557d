//! Runs of the bench with the image on virtual silicon.

use std::fs;

use rustix::process::Signal;
use tests::paper::PATIENCE;
use tests::program;
use tests::records::Records;
use tests::{loss, processes};

use crate::equipment;

/// Length of the run whose speed is reported. A step takes about 0.7 ms.
const DURATION: &str = "run.duration_s=3";
const STEPS: u64 = 3_000;

pub(crate) fn identity() {
    let records = Records::new();
    let arguments = ["run", "scenarios/smooth-after.toml", "--device", "silicon", "--out", &records.out()];
    let _ = program::run(arguments.into_iter().chain(["--set", "run.duration_s=0.01"])).with_code(1);
    let summary = records.summary();
    let device = summary["device"].as_str().expect("the device");
    // The name of the board itself: the image does not take the models for QEMU.
    assert!(device.starts_with("silicon (stm32f405, firmware "), "{device}");
    let files = summary["evidence"]["files"].as_array().expect("the files that ran as the drive");
    let paths: Vec<_> = files.iter().filter_map(|file| file["path"].as_str()).collect();
    assert!(
        paths[0].ends_with("lashloop-firmware.elf") && paths[1].ends_with("lashloop-silicon"),
        "{paths:?}"
    );
}

/// Steps per second, for the report.
pub(crate) fn speed() {
    let records = Records::new();
    let arguments = ["run", "scenarios/smooth-after.toml", "--device", "silicon", "--out", &records.out()];
    let _ = program::run(arguments.into_iter().chain(["--set", DURATION]).chain(PATIENCE));
    let summary = records.summary();
    assert_eq!(summary["steps"], STEPS, "a run cut short has no speed");
    let wall_s = summary["wall_s"].as_f64().expect("a time");
    let line = format!("virtual silicon: {:.0} steps/s in lockstep with the bench", STEPS as f64 / wall_s);
    println!("{line}");
    let reports = tests::workspace().join("target/reports");
    fs::create_dir_all(&reports).expect("the folder of the reports");
    fs::write(reports.join("silicon.txt"), line + "\n").expect("a report");
}

pub(crate) fn killed() {
    let (bench, records) = loss::run_in_progress("silicon");
    let [silicon] = processes::children(bench.id())[..] else { panic!("the bench has one child") };
    // Linux keeps 15 characters of a name.
    assert_eq!(processes::name(silicon), "lashloop-silico");
    let lost_at = std::time::Instant::now();
    processes::signal(silicon, Signal::KILL);
    let sentence = loss::assert_reported(bench, &records, lost_at);
    let named = format!(
        "the drive side ended during the session with silicon: the virtual silicon (process {silicon})"
    );
    assert!(sentence.contains(&named), "{sentence}");
}

/// An image that no drive is.
pub(crate) fn stranger() {
    let records = Records::new();
    let image = records.path("text.elf");
    fs::write(&image, "no image").expect("a file of the test");
    let device = format!("silicon:{}", image.display());
    let ended = program::run(["run", "scenarios/smooth-after.toml", "--device", &device]).with_code(4);
    assert_eq!(ended.stderr.lines().count(), 1, "{}", ended.stderr);
    assert!(ended.stderr.contains("text.elf isn't an image"), "{}", ended.stderr);
}

/// An image that boots and speaks no protocol.
pub(crate) fn silent() {
    let device = format!("silicon:{}", equipment::probe().display());
    let ended = program::run(["run", "scenarios/smooth-after.toml", "--device", &device]).with_code(4);
    assert!(ended.stderr.contains("silent"), "{}", ended.stderr);
}

pub(crate) fn no_image() {
    let ended =
        program::run(["run", "scenarios/smooth-after.toml", "--device", "silicon:no/such.elf"]).with_code(4);
    let want = "lashloop: no image of the firmware at no/such.elf: build it with `cargo xtask image`, or name it by \
                silicon:PATH or LASHLOOP_IMAGE\n";
    assert_eq!((ended.stderr.as_str(), ended.stdout.as_str()), (want, ""));
}
