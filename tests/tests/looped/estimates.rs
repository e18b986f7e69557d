//! The drive's estimates: the bench's scores against scores computed from the trace.

use tests::paper::PATIENCE;
use tests::program;
use tests::records::Records;

#[test]
fn estimates_are_scored_at_their_own_samples() {
    for (every, device) in [(7, "inproc"), (1, "inproc"), (7, "native"), (1, "native")] {
        let records = Records::new();
        let every_steps = format!("telemetry.every_steps={every}");
        let arguments =
            ["run", "scenarios/shaft-backlash-inverse.toml", "--device", device, "--out", &records.out()];
        let overrides = ["--set", &every_steps, "--set", "run.duration_s=8", "--set", "expect=[]"];
        let _ = program::run(arguments.into_iter().chain(overrides).chain(PATIENCE)).with_code(0);
        let trace = records.trace();
        let column = |name| trace.column(name);
        let (time_s, telemetry_time_s) = (column("time_s"), column("telemetry_time_s"));
        for step in 0..trace.len() {
            assert_eq!(
                telemetry_time_s[step],
                time_s[step - step % every],
                "telemetry of {device}, step {step}"
            );
        }
        let (truth_nm, estimate_nm) =
            (column("disturbing_torque_nm"), column("drive.disturbing_torque_estimate_nm"));
        let (transmitted_nm, twist_rad) = (column("transmitted_torque_nm"), column("twist_rad"));
        // w = C - K z, with K = 1 N m/rad.
        let away = (0..trace.len()).map(|i| (transmitted_nm[i] - twist_rad[i] - truth_nm[i]).abs());
        assert!(away.fold(0.0, f64::max) < 1e-12);
        let errors_nm: Vec<_> =
            (0..trace.len()).step_by(every).map(|i| estimate_nm[i] - truth_nm[i]).collect();
        let mean = |sum: f64| sum / errors_nm.len() as f64;
        let bias_nm = mean(errors_nm.iter().sum());
        let rms_nm = mean(errors_nm.iter().map(|error| error * error).sum()).sqrt();
        let summary = records.summary();
        for (metric, want) in
            [("disturbing_torque_bias_nm", bias_nm), ("disturbing_torque_rms_error_nm", rms_nm)]
        {
            let have = summary["metrics"][metric].as_f64().expect("a number");
            assert!((have - want).abs() < 1e-9, "{metric} on {device}: have {have}, want {want}");
        }
        // At rest, from 6.4 s on, the observer has converged.
        let late_nm = &errors_nm[errors_nm.len() * 7 / 8..];
        assert!(late_nm.iter().all(|error| error.abs() < 0.02), "the drive estimates: {late_nm:?} N m off");
    }
}

#[test]
fn only_the_selected_signals_are_recorded() {
    let records = Records::new();
    let arguments = ["run", "scenarios/shaft-merzouki.toml", "--device", "native", "--out", &records.out()];
    let signals = "telemetry.signals=[\"load_error_rad\", \"requested_torque_nm\"]";
    let settings = ["run.duration_s=1", "expect=[]", "telemetry.every_steps=1", signals];
    let settings = settings.into_iter().flat_map(|setting| ["--set", setting]);
    let _ = program::run(arguments.into_iter().chain(settings).chain(PATIENCE)).with_code(0);
    let trace = records.trace();
    let of_drive: Vec<_> = trace.header().into_iter().filter(|name| name.starts_with("drive.")).collect();
    // In the order of the drive, not of the scenario.
    assert_eq!(of_drive, ["drive.requested_torque_nm", "drive.load_error_rad"]);
    let summary = records.summary();
    assert_eq!(summary["telemetry"]["signals"], serde_json::json!(["requested_torque_nm", "load_error_rad"]));
    // The drive's error is that of the load, within a count of 4000 and single precision.
    let column = |name| trace.column(name);
    let (load, reference, error) =
        (column("load_position_rad"), column("reference_rad"), column("drive.load_error_rad"));
    let worst = (0..trace.len()).map(|i| (load[i] - reference[i] - error[i]).abs()).fold(0.0, f64::max);
    assert!(worst < 2e-3, "the drive's error differs by {worst} rad");
    let (requested, torque) = (column("drive.requested_torque_nm"), column("torque_nm"));
    let within = (0..trace.len()).filter(|&i| requested[i].abs() <= 20.0);
    assert!(within.clone().count() > 500 && within.clone().all(|i| requested[i] == torque[i]));
}
