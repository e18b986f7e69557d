//! The section `[scope]`: what the drive captures, in the record and in a figure.

use std::fs;
use std::path::Path;

use lashloop_record::reader::Record;
use lashloop_record::table;

use crate::support::{lashloop, root, text};

const TWIST: &str = "drive.measured_twist_rad";
const TORQUE: &str = "drive.requested_torque_nm";
/// Passed upwards by the twist of a quarter of a turn that the law closes.
const LEVEL_RAD: f64 = 0.01;

/// A run of the native twin with the telemetry of every step; exit code and standard error.
fn run(out: &Path, settings: &[&str]) -> (Option<i32>, String) {
    let scenario = root().join("scenarios/smooth-after.toml");
    let mut arguments = vec!["run", scenario.to_str().unwrap(), "--out", out.to_str().unwrap()];
    let short = ["run.duration_s=5", "telemetry.every_steps=1", "expect=[]"];
    arguments.extend(short.iter().chain(settings).flat_map(|setting| ["--set", setting]));
    let ended = lashloop(&arguments, &[]);
    (ended.status.code(), format!("{}{}", text(&ended.stderr), text(&ended.stdout)))
}

const AT_TWIST: [&str; 3] = [
    "scope.signals=[\"measured_twist_rad\", \"requested_torque_nm\"]",
    "scope.trigger=rising",
    "scope.level=0.01",
];

#[test]
fn a_capture_has_the_telemetry_of_every_step_around_its_event() {
    let folder = tempfile::tempdir().unwrap();
    let (code, output) = run(folder.path(), &AT_TWIST);
    assert_eq!(code, Some(0), "{output}");
    assert!(output.contains("scope       512 rows, the event at row 64"), "{output}");
    let captured = table::read(&folder.path().join("scope.csv")).unwrap();
    let time_s = captured.get("time_s").unwrap();
    let want_s: Vec<_> = (-64..448).map(|step| f64::from(step) / 1e3).collect();
    assert_eq!(time_s, want_s, "relative to the event");
    let twist_rad = captured.get(TWIST).unwrap();
    assert!(twist_rad[63] < LEVEL_RAD && twist_rad[64] >= LEVEL_RAD, "{:?}", &twist_rad[60..68]);
    let record = Record::read(folder.path()).unwrap();
    let sent_rad = record.trace.get(TWIST).unwrap();
    let event = sent_rad.windows(2).position(|pair| pair[0] < LEVEL_RAD && pair[1] >= LEVEL_RAD).unwrap() + 1;
    for signal in [TWIST, TORQUE] {
        let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
        let sent = &record.trace.get(signal).unwrap()[event - 64..event + 448];
        assert_eq!(bits(captured.get(signal).unwrap()), bits(sent), "{signal}");
    }
}

#[test]
fn a_capture_is_drawn_over_the_time_from_its_event_on() {
    let folder = tempfile::tempdir().unwrap();
    let (code, output) = run(folder.path(), &AT_TWIST);
    assert_eq!(code, Some(0), "{output}");
    let table = folder.path().join("scope.csv");
    let plot = |more: &[&str]| {
        let ended = lashloop(&[&["plot", table.to_str().unwrap()], more].concat(), &[]);
        assert_eq!(ended.status.code(), Some(0), "{}", text(&ended.stderr));
        fs::read_to_string(folder.path().join("scope.svg")).unwrap()
    };
    let svg = plot(&[]);
    for words in
        ["512 rows of a table.", "measured_twist_rad", "(rad)", "requested_torque_nm", "(N m)", "time (s)"]
    {
        assert!(svg.contains(words), "no {words:?}");
    }
    assert!(plot(&["--from", "-0.01", "--until", "0.02"]).contains("31 rows of a table."));
}

#[test]
fn a_run_without_the_event_has_its_verdict_and_no_rows() {
    let folder = tempfile::tempdir().unwrap();
    let (code, output) = run(folder.path(), &[AT_TWIST[0], AT_TWIST[1], "scope.level=1000"]);
    assert_eq!(code, Some(0), "{output}");
    assert!(output.contains("no rows of [scope]: NotCaptured: the event did not come"), "{output}");
    assert!(!folder.path().join("scope.csv").exists());
}

#[test]
fn rows_beyond_the_memory_of_the_drive_are_an_error_before_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let (code, output) = run(folder.path(), &[AT_TWIST[0], "scope.before_rows=512"]);
    assert_eq!(code, Some(2), "{output}");
    let want = "scope.before_rows: 512 is refused: the drive answered OutOfRange; its memory takes more rows of fewer signals";
    assert!(output.contains(want), "{output}");
}

#[test]
fn a_later_record_in_the_folder_drops_the_capture_of_the_earlier_one() {
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(run(folder.path(), &AT_TWIST).0, Some(0));
    assert!(folder.path().join("scope.csv").exists());
    let scenario = root().join("scenarios/smooth-after.toml");
    let [scenario, out] = [&scenario, folder.path()].map(|path| path.to_str().unwrap());
    let short = ["--set", "run.duration_s=0.1", "--set", "expect=[]"];
    let ended = lashloop(&[&["run", scenario, "--out", out, "--force"], &short[..]].concat(), &[]);
    assert_eq!(ended.status.code(), Some(0), "{}", text(&ended.stderr));
    assert!(!folder.path().join("scope.csv").exists());
}
