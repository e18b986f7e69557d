//! `summary.json` and the columns of a run as a whole.

use tests::paper::{PATIENCE, RUNS};
use tests::program;
use tests::records::Records;

/// The text without the values of these keys, which change from run to run or from commit to commit.
fn without(text: &str, keys: &[&str]) -> String {
    let line = |line: &str| match line.split_once(": ") {
        Some((key, value)) if keys.contains(&key.trim().trim_matches('"')) => {
            format!("{key}: [changes]{}\n", if value.ends_with(',') { "," } else { "" })
        }
        _ => format!("{line}\n"),
    };
    text.lines().map(line).collect()
}

/// The text without an object of the summary.
fn without_object(text: &str, name: &str) -> String {
    let (before, rest) = text.split_once(&format!("  \"{name}\": {{")).expect(name);
    let (_, after) = rest.split_once("\n  },\n").expect("the end of the object");
    format!("{before}{after}")
}

#[test]
fn a_summary_has_all_that_identifies_and_repeats_a_run() {
    let records = Records::new();
    let arguments = ["run", &RUNS[1].scenario(), "--device", "native", "--out", &records.out()];
    let _ = program::run(arguments.into_iter().chain(PATIENCE)).with_code(0);
    let text = records.summary_text().expect("a summary");
    assert!(text.ends_with("}\n"), "whole, with an end of line");
    let summary = records.summary();
    let wall_s = summary["wall_s"].as_f64().expect("the wall-clock time");
    assert!(wall_s > 0.0, "have {wall_s} s");
    let device = summary["device"].as_str().expect("the device");
    assert!(device.starts_with("native (native-twin, firmware "), "{device}");
    let build = summary["versions"]["firmware_build"].as_str().expect("the build of the firmware");
    assert!(build.len() == 8 && device.contains(build), "{build} of {device}");
    let changing = ["device", "wall_s", "firmware_build", "firmware_dirty"];
    let evidence = &summary["evidence"];
    assert_eq!(evidence["files"][0]["sha256"].as_str().map(str::len), Some(64), "{evidence}");
    let lasting = without_object(&without_object(&text, "timing"), "evidence");
    insta::assert_snapshot!(without(&lasting, &changing));
    let timing = &summary["timing"];
    assert_eq!((&timing["clock"], &timing["steps"]), (&"lockstep".into(), &25_000.into()));
    let quantiles = |name: &str| {
        ["p50", "p99", "p99_9", "max"].map(|quantile| timing[name][quantile].as_f64().expect("a time"))
    };
    for part in ["round_trip_us", "send_us", "line_and_device_us", "compute_us", "receive_us"] {
        let quantiles = quantiles(part);
        assert!(quantiles.is_sorted() && quantiles[3] > 0.0, "{part}: {quantiles:?}");
    }
    let bins = timing["round_trip_histogram"].as_array().expect("bins");
    assert_eq!(bins.iter().map(|bin| bin[1].as_u64().expect("a count")).sum::<u64>(), 25_000);
}

#[test]
fn a_trace_has_the_truth_of_the_plant_for_every_step() {
    let records = Records::new();
    let arguments = ["run", &RUNS[1].scenario(), "--device", "native", "--out", &records.out()];
    let _ = program::run(arguments.into_iter().chain(PATIENCE)).with_code(0);
    let trace = records.trace();
    insta::assert_snapshot!(trace.header().join("\n"));
    let column = |name| trace.column(name);
    let time_s = column("time_s");
    assert!(time_s.iter().enumerate().all(|(step, time_s)| (time_s - step as f64 * 1e-3).abs() < 1e-9));
    let start = |name| column(name)[0];
    assert_eq!(start("load_position_rad"), std::f64::consts::FRAC_PI_2);
    assert_eq!(start("motor_position_rad"), 3.0 * std::f64::consts::FRAC_PI_2);
    // z = theta_e - N0 theta_s, with N0 = 3.
    let (motor, load, twist) =
        (column("motor_position_rad"), column("load_position_rad"), column("twist_rad"));
    let worst = (0..trace.len()).map(|i| (motor[i] - 3.0 * load[i] - twist[i]).abs()).fold(0.0, f64::max);
    assert!(worst < 1e-12, "twist differs from motor and load by {worst} rad");
}
