//! A waiting process takes almost no processor time.

use std::fs;
use std::thread;
use std::time::{Duration, Instant};

use tests::paper::RUNS;
use tests::processes;
use tests::program::{self, Running};
use tests::terminal;
use tests::twin::Twin;

/// Time of observation.
const WATCHED: Duration = Duration::from_secs(1);
/// Largest load of a core, in percent.
const LIMIT_PERCENT: f64 = 2.0;

/// Processor time of a process and all its threads so far, in user and system mode.
fn processor_s(id: u32) -> f64 {
    let line = fs::read_to_string(format!("/proc/{id}/stat")).expect("a process that runs");
    // The name in parentheses may contain any character, so we parse after its end, which the third field follows.
    let (_, rest) = line.rsplit_once(") ").expect("a name");
    let ticks = |field: usize| -> u64 {
        rest.split(' ').nth(field - 3).and_then(|text| text.parse().ok()).expect("ticks")
    };
    let per_second = rustix::param::clock_ticks_per_second() as f64;
    (ticks(14) + ticks(15)) as f64 / per_second
}

/// Load of a core over the time of observation, in percent.
fn load_percent(id: u32) -> f64 {
    let (started, before_s) = (Instant::now(), processor_s(id));
    thread::sleep(WATCHED);
    100.0 * (processor_s(id) - before_s) / started.elapsed().as_secs_f64()
}

#[test]
fn a_busy_process_exceeds_the_limit() {
    let bench = Running::start([
        "run",
        "scenarios/smooth-after.toml",
        "--device",
        "inproc",
        "--set",
        "run.duration_s=90000",
    ]);
    thread::sleep(Duration::from_millis(200));
    let load = load_percent(bench.id());
    assert!(load > 2.0 * LIMIT_PERCENT, "{load} %");
}

#[test]
fn a_waiting_drive_is_idle_before_and_after_a_real_time_run() {
    let twin = Twin::start();
    let before = load_percent(twin.id());
    assert!(before < LIMIT_PERCENT, "{before} % before a run");
    let (scenario, device) = (RUNS[1].scenario(), twin.device());
    let arguments =
        ["run", &scenario, "--device", &device, "--clock", "real-time", "--set", "run.duration_s=1"];
    let ended = program::run(arguments);
    assert!(ended.stdout.contains("timing      real time"), "{}{}", ended.stdout, ended.stderr);
    let after = load_percent(twin.id());
    assert!(after < LIMIT_PERCENT, "{after} % after a run");
}

#[test]
fn a_bench_that_waits_for_a_drive_is_idle() {
    // No drive answers there; the handshake times out after 2.5 s.
    let silent = terminal::open();
    for clock in ["lockstep", "real-time"] {
        let bench = Running::start([
            "run",
            "scenarios/smooth-after.toml",
            "--device",
            &terminal::device(&silent),
            "--clock",
            clock,
        ]);
        thread::sleep(Duration::from_millis(200));
        let load = load_percent(bench.id());
        assert!(load < LIMIT_PERCENT, "{load} %, {clock}");
        assert!(processes::runs(bench.id()), "it was still waiting, {clock}");
    }
}

#[test]
fn a_bench_whose_drive_hangs_is_idle() {
    let twin = Twin::start();
    let (scenario, device) = (RUNS[1].scenario(), twin.device());
    let patient = ["--set", "link.answer_timeout_ms=20000", "--set", "link.silence_limit_ms=40000"];
    let arguments = ["run", &scenario, "--device", &device, "--set", "run.duration_s=90000"];
    let bench = Running::start(arguments.into_iter().chain(patient));
    thread::sleep(Duration::from_millis(500));
    twin.signal(rustix::process::Signal::STOP);
    thread::sleep(Duration::from_millis(100));
    let load = load_percent(bench.id());
    twin.signal(rustix::process::Signal::CONT);
    assert!(load < LIMIT_PERCENT, "{load} %");
}
