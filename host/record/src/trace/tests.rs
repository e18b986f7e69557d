//! Traces as text in a file.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

use super::{TraceWriter, columns, position_decimals};
use crate::digits::Digits;
use crate::reader::{Record, Table};
use crate::samples::{SampleWriter, Samples};
use crate::table::TableWriter;
use lashloop_bench::run::{DriveValues, Step, TraceRow};
use lashloop_bench::scenario::sections::EncoderSettings;
use lashloop_bench::timing::{RoundTrip, StepOutcome, StepTiming};
use lashloop_plant::Signal;
use lashloop_plant::metrics::SignalTable;
use lashloop_protocol::EncoderCounts;
use lashloop_protocol::message::EncoderSample;

const ENCODERS: EncoderSettings =
    EncoderSettings { motor_counts_per_rev: 131_072, load_counts_per_rev: 4096, noise_counts: 0.0 };

fn signals() -> SignalTable {
    SignalTable {
        plant: vec![Signal::new("twist_rad", "rad")],
        drive: vec![Signal::new("requested_torque_nm", "N m"), Signal::new("backlash, wide", "")],
    }
}

/// Every fifth step has telemetry of its own, every seventh no sample.
fn step(number: u32) -> Step {
    let value = f64::from(number);
    let telemetry = number / 5 * 5;
    Step {
        row: TraceRow {
            time_s: value * 0.001,
            reference_rad: 0.0,
            load_position_rad: std::f64::consts::FRAC_PI_2 / (value + 1.0),
            motor_position_rad: -1e-7 * value,
            torque_nm: f64::from(0.1_f32),
        },
        sample: (number % 7 != 6).then(|| EncoderSample {
            sequence: number as u16,
            motor_counts: EncoderCounts::wrapping(-8_388_608 + i64::from(number)),
            load_counts: EncoderCounts::wrapping(512),
            reference_rad: 0.0,
        }),
        plant: [-1.0 / 3.0].into_iter().collect(),
        drive: DriveValues {
            values: [f64::from(telemetry), 1e-9].into_iter().collect(),
            time_s: Some(f64::from(telemetry) * 0.001),
        },
        timing: StepTiming {
            lateness: Duration::ZERO,
            outcome: StepOutcome::Answered,
            round_trip: None,
            tick_compute: None,
        },
    }
}

fn place() -> (tempfile::TempDir, PathBuf) {
    let directory = tempfile::tempdir().expect("a temporary directory");
    let path = directory.path().join("trace.csv");
    (directory, path)
}

fn create(folder: &Path, flush_rows: u32) -> TraceWriter {
    TraceWriter::create(folder, &signals(), &ENCODERS, flush_rows).expect("a trace")
}

fn data_rows(path: &Path) -> usize {
    let text = fs::read_to_string(path).expect("a trace");
    assert!(text.ends_with('\n'), "a torn row: {:?}", text.lines().last());
    text.lines().count() - 1
}

#[test]
fn a_trace_has_new_telemetry_only_and_no_truth_of_the_plant() {
    let (directory, path) = place();
    let mut writer = create(directory.path(), 1000);
    (4..8).for_each(|number| writer.push(&step(number)).expect("a row"));
    writer.finish().expect("the rows");
    insta::assert_snapshot!(fs::read_to_string(&path).expect("a trace"), @r#"
    time_s,reference_rad,load_position_rad,motor_position_rad,torque_nm,drive.requested_torque_nm,"drive.backlash, wide",telemetry_time_s,motor_counts,load_counts
    0.004,0,0.31416,0,0.1,0,1.000e-9,0,-8388604,512
    0.005,0,0.2618,0,0.1,5,1.000e-9,0.005,-8388603,512
    0.006,0,0.2244,0,0.1,,,,,
    0.007,0,0.19635,0,0.1,,,,-8388601,512
    "#);
}

#[test]
fn a_trace_without_samples_reads_back_with_units_and_repeated_telemetry() {
    let (directory, path) = place();
    let mut writer = create(directory.path(), 1);
    (0..12).for_each(|number| writer.push(&step(number)).expect("a row"));
    drop(writer);
    let trace = Record::read(directory.path()).expect("a record").trace;
    let units = ["time_s", "motor_counts", "drive.requested_torque_nm", "drive.backlash, wide"];
    assert_eq!(units.map(|it| trace.columns.unit(it)), [Some("s"), Some("counts"), Some("N m"), Some("")]);
    let repeated: Vec<_> = (0..12).map(|number| f64::from(number / 5 * 5)).collect();
    assert_eq!(trace.columns.get("drive.requested_torque_nm"), Some(&repeated[..]));
    assert!(trace.columns.get("motor_counts").expect("counts")[6].is_nan(), "no sample, no counts");

    // The trace alone has no units, and a damaged list is an error of its own.
    assert_eq!(Table::read(&path).expect("a table").columns.unit("time_s"), Some(""));
    fs::write(directory.path().join("trace.json"), "{").expect("a damaged list");
    let error = Record::read(directory.path()).expect_err("a damaged list").to_string();
    assert!(error.contains("trace.json: is not the list of a trace's columns: "), "{error}");
}

#[test]
fn positions_are_rounded_to_an_eighth_of_a_count() {
    for (counts_per_rev, decimals) in [(4, 1), (4096, 4), (131_072, 5), (1 << 24, 8)] {
        let encoders =
            EncoderSettings { load_counts_per_rev: counts_per_rev, motor_counts_per_rev: 4, ..ENCODERS };
        assert_eq!(position_decimals(&encoders), decimals, "{counts_per_rev} counts/rev");
        let count_rad = std::f64::consts::TAU / f64::from(counts_per_rev);
        assert!(0.5 * 10_f64.powi(-i32::from(decimals)) <= count_rad / 8.0);
    }
}

#[test]
fn rows_reach_the_file_whole_and_flush_rows_at_a_time() {
    let (directory, path) = place();
    let mut writer = create(directory.path(), 10);
    for number in 0..25 {
        writer.push(&step(number)).expect("a row");
        assert_eq!(data_rows(&path), (number as usize + 1) / 10 * 10, "after step {number}");
    }
    drop(writer);
    assert_eq!(data_rows(&path), 25);
}

#[test]
fn an_existing_trace_is_replaced() {
    let (directory, path) = place();
    fs::write(&path, "x".repeat(10_000)).expect("an old trace");
    create(directory.path(), 1).finish().expect("a trace");
    assert_eq!(data_rows(&path), 0);
}

#[test]
fn a_file_that_cannot_be_made_is_named() {
    let error =
        TraceWriter::create(Path::new("no/such"), &signals(), &ENCODERS, 1).expect_err("no directory");
    assert_eq!(
        error.to_string(),
        "no/such/trace.json: cannot be created: No such file or directory (os error 2)"
    );
}

/// `/dev/full` refuses every byte, as a full disk does.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_reported_with_the_path() {
    let column = [("time_s", Digits::Exact)];
    let error = TableWriter::create(Path::new("/dev/full"), column, 1).expect_err("a full disk");
    assert_eq!(error.to_string(), "/dev/full: cannot be written: No space left on device (os error 28)");
}

#[test]
fn a_plant_may_take_none_of_the_columns_of_every_trace() {
    let columns = columns(&SignalTable::default());
    let names: Vec<_> = columns.iter().map(|column| &*column.name).collect();
    assert_eq!(names, lashloop_plant::FIXED_COLUMNS);
    // What expectations may name in every run, with the same units, is all but the times and what was sent.
    assert_eq!(columns[1..columns.len() - 4], lashloop_plant::metrics::FIXED_SIGNALS);
}

#[test]
fn samples_keep_times_of_any_length() {
    let (directory, _) = place();
    let long = Duration::from_nanos(86_400_000_000_123);
    // A day into a run at 1 kHz, a machine was suspended.
    let first = 86_400_000;
    let mut writer = SampleWriter::create(directory.path(), &signals(), 1000, first, &[]).expect("a file");
    for lateness in [Duration::from_nanos(1), Duration::from_secs(3), long] {
        let round_trip =
            Some(RoundTrip { send: lateness, line_and_device: long, compute: long, receive: long });
        let timing = StepTiming { lateness, round_trip, ..step(0).timing };
        writer.push(&Step { timing, ..step(0) });
    }
    writer.finish(("summary.json", "{}")).expect("a file");
    let Samples { trace, timing, .. } = Samples::read(&directory.path().join("run.mcap")).expect("samples");
    let times_s = [0.0, 1.0, 2.0].map(|step| (first as f64 + step) * 0.001);
    assert_eq!(trace.get("time_s"), Some(&times_s[..]));
    for column in ["lateness_us", "send_us"] {
        assert_eq!(timing.get(column), Some(&[0.001, 3e6, 86_400_000_000.123][..]), "{column}");
    }
    assert_eq!(timing.get("receive_us"), Some(&[86_400_000_000.123; 3][..]));
}
