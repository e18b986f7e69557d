//! Loss of the emulated board, or of its bench, during a run.

use std::time::Instant;

use rustix::process::Signal;
use tests::loss::{assert_reported, assert_waited_for, run_in_progress};
use tests::program::Running;
use tests::records::Records;
use tests::{processes, wait};

/// A run in progress and its emulator.
fn running() -> (Running, Records, u32) {
    let (bench, records) = run_in_progress("qemu");
    let [emulator] = processes::children(bench.id())[..] else { panic!("the bench has one child") };
    assert_eq!(processes::name(emulator), "qemu-system-arm");
    (bench, records, emulator)
}

pub(crate) fn killed() {
    let (bench, records, emulator) = running();
    let lost_at = Instant::now();
    processes::signal(emulator, Signal::KILL);
    let sentence = assert_reported(bench, &records, lost_at);
    let names = [
        format!("the drive side ended during the session with qemu: the emulator (process {emulator})"),
        "signal: 9".to_owned(),
    ];
    assert!(names.iter().all(|name| sentence.contains(name)), "{sentence}");
}

pub(crate) fn stopped() {
    assert_waited_for("scenarios/faults.toml", "qemu", 2);
}

pub(crate) fn bench_killed() {
    let (bench, records, emulator) = running();
    bench.signal(Signal::KILL);
    assert_eq!(bench.wait().code, None);
    wait::until("the end of the emulator", || (!processes::runs(emulator)).then_some(()));
    assert!(!records.trace().is_empty(), "rows of the trace");
}

pub(crate) fn bench_interrupted() {
    let (bench, records, emulator) = running();
    bench.signal(Signal::INT);
    let _ = bench.wait().with_code(3);
    assert!(!processes::runs(emulator), "the emulator still runs");
    assert_eq!(records.summary()["verdict"], "INVALID");
}
