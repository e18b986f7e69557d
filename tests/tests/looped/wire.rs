//! The modelled wire, `link.modelled_baud`.

use serde_json::Value;
use tests::paper::{PATIENCE, RUNS};
use tests::program;
use tests::records::Records;

/// Bytes of a sample, a torque and a telemetry frame.
const SAMPLE: f64 = 19.0;
const TORQUE: f64 = 16.0;
const TELEMETRY: f64 = 33.0;

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

fn number(summary: &Value, keys: [&str; 2]) -> f64 {
    summary[keys[0]][keys[1]].as_f64().unwrap_or_else(|| panic!("{keys:?} in {summary}"))
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
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

#[test]
fn telemetry_delays_the_torque_behind_it() {
    // So slow that the delays of a busy machine are small in comparison.
    let baud = 38_400;
    let round_trips_us = |every: &str| {
        let records = run("native", baud, &["--set", "run.duration_s=0.3", "--set", every]);
        let all = records.timing().column("line_and_device_us");
        // Telemetry follows the torque of steps 0, 10, 20 and so on.
        let of = |phase: usize| median(all.iter().skip(phase).step_by(10).copied().collect());
        (of(1), of(5))
    };
    let (behind, others) = round_trips_us("telemetry.every_steps=10");
    // In lockstep the next sample follows at once, and telemetry passes while the sample is on the wire.
    let delay_us = 1e6 * wire_s(TELEMETRY - SAMPLE, baud);
    assert!(behind - others > 0.6 * delay_us, "{behind} us behind telemetry, {others} us else, {delay_us}");
    assert!(others >= 1e6 * wire_s(SAMPLE + TORQUE, baud), "{others}");
    let (behind, others) = round_trips_us("telemetry.every_steps=0");
    assert!((behind - others).abs() < 0.4 * delay_us, "{behind} us and {others} us without telemetry");
}

#[test]
fn in_real_time_too_slow_a_wire_makes_the_run_invalid() {
    // A long watchdog time, so that the verdict depends on the wire alone.
    let watchdog = "controller.parameters.watchdog_us=10000000";
    let more = ["--clock", "real-time", "--set", "run.duration_s=2", "--set", watchdog];
    let late_fraction = |baud| {
        let summary = run("native", baud, &more).summary();
        let steps = number(&summary, ["timing", "steps"]);
        // A saturated wire blocks the bench, so steps are missed as well.
        let late = ["unanswered", "missed"].map(|kind| number(&summary, ["timing", kind]));
        let fraction = late.iter().sum::<f64>() / steps;
        (fraction, summary["verdict"].clone())
    };
    // The 19 bytes of a sample take 1.65 ms.
    let (slow, verdict) = late_fraction(115_200);
    assert!(slow > 0.9 && verdict == "INVALID", "{slow} of the steps late, {verdict}");
    // Sample and torque take 0.38 ms, which leaves 0.62 ms for a busy machine.
    let (fast, _) = late_fraction(921_600);
    assert!(fast < 0.75 * slow, "{fast} of the steps late, {slow} at the slow rate");
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
