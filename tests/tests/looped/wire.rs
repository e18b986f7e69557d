//! The modelled wire, `link.modelled_baud`.

use lashloop_bench::verdict::Verdict;
use tests::paper::{PATIENCE, RUNS};
use tests::program;
use tests::records::Records;
use tests::scripted::{Made, Script};

/// Bytes of a sample, a torque and a telemetry frame of eleven signals.
const SAMPLE: f64 = 19.0;
const TORQUE: f64 = 16.0;
const TELEMETRY: f64 = 53.0;

/// Wire time of `bytes`.
fn wire_s(bytes: f64, baud: u32) -> f64 {
    bytes * 10.0 / f64::from(baud)
}

fn run(device: &str, baud: u32, more: &[&str]) -> Records {
    let records = Records::new();
    let (scenario, out, baud) = (RUNS[1].scenario(), records.out(), format!("link.modelled_baud={baud}"));
    let arguments = ["run", &scenario, "--device", device, "--out", &out, "--set", &baud];
    let _ = program::run(arguments.into_iter().chain(PATIENCE).chain(more.iter().copied()));
    records
}

#[test]
fn in_lockstep_a_modelled_wire_costs_time_and_no_torque_bit() {
    for device in ["inproc", "native"] {
        let baud = 4_000_000;
        let summary = run(device, baud, &[]).summary();
        assert_eq!((&summary["verdict"], &summary["steps"]), (&"PASS".into(), &25_000.into()), "{device}");
        assert_eq!(summary["torque_sha256"], RUNS[1].torque_sha256, "{device}: other torques");
        let (wall_s, least_s) = (summary["wall_s"].as_f64(), 25_000.0 * wire_s(SAMPLE + TORQUE, baud));
        assert!(wall_s.expect("a time") >= least_s, "{device}: {wall_s:?} s, the wire takes {least_s} s");
        let who = summary["device"].as_str().expect("a device");
        assert!(who.ends_with(", wire modelled at 4000000 Bd"), "{who}");
    }
}

/// Makes a run in real time at this speed, with a scripted clock.
fn scripted(baud: u32, settings: &[&str]) -> Made {
    let baud = format!("link.modelled_baud={baud}");
    let settings = [&[&*baud, "expect=[]", "controller.parameters.watchdog_us=10000000"], settings].concat();
    Script { scenario: "scenarios/smooth-after.toml", settings: &settings, ..Script::default() }.run()
}

#[test]
fn telemetry_delays_the_torque_behind_it() {
    // A byte takes 17.4 us.
    let baud = 576_000;
    let round_trip_us = |step: usize, settings: &[&str]| {
        let made = scripted(baud, &[&["run.duration_s=0.3"], settings].concat());
        let round_trip = made.steps[step].timing.round_trip.expect("an answer");
        round_trip.line_and_device.as_secs_f64() * 1e6
    };
    let alone_us = 1e6 * wire_s(SAMPLE + TORQUE, baud);
    // Telemetry follows the torque of steps 0, 10, 20 and so on. It is on the wire when the next sample has passed.
    let behind_us = 1e6 * wire_s(SAMPLE + TORQUE + TELEMETRY + TORQUE, baud) - 1e3;
    let with_telemetry = ["telemetry.every_steps=10"];
    for (step, settings, want_us) in [
        (5, &with_telemetry[..], alone_us),
        (11, &with_telemetry, behind_us),
        (11, &["telemetry.every_steps=0"], alone_us),
    ] {
        let us = round_trip_us(step, settings);
        assert!((us - want_us).abs() < 0.1, "step {step}, {settings:?}: {us} us, {want_us} us expected");
    }
}

#[test]
fn in_real_time_too_slow_a_wire_makes_the_run_invalid() {
    let late_and_verdict = |baud| {
        let made = scripted(baud, &["run.duration_s=2"]);
        let outcome = made.outcome();
        // A saturated wire blocks the bench, so steps are missed as well.
        (outcome.timing.unanswered + outcome.timing.missed, outcome.judgement.verdict)
    };
    // The 19 bytes of a sample take 1.65 ms. The first one is sent again until its answer comes, which is in time then.
    assert_eq!(late_and_verdict(115_200), (2_000 - 1, Verdict::Invalid));
    // Sample and torque take 0.38 ms.
    assert_eq!(late_and_verdict(921_600), (0, Verdict::Pass));
}

#[test]
fn a_serial_port_rejects_a_modelled_wire() {
    let arguments = ["run", "scenarios/smooth-after.toml", "--device", "/dev/null"];
    let ended = program::run(arguments.into_iter().chain(["--set", "link.modelled_baud=9600"])).with_code(4);
    assert_eq!(
        ended.stderr,
        "lashloop: /dev/null: a serial port has a UART of its own, at link.baud = 921600; link.modelled_baud is for \
         drives without one, so leave it 0 here\n"
    );
}
