//! Columns of a trace, and times of its samples.

use std::time::Duration;

use super::columns;
use crate::samples::{SampleWriter, Samples, StepTimes};
use lashloop_bench::run::{DriveValues, Step, TraceRow};
use lashloop_bench::timing::{RoundTrip, StepOutcome, StepTiming};
use lashloop_plant::metrics::SignalTable;

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
    let directory = tempfile::tempdir().expect("a temporary directory");
    let long = Duration::from_nanos(86_400_000_000_123);
    // A day into a run at 1 kHz, a machine was suspended.
    let first = 86_400_000;
    let signals = SignalTable::default();
    let times = StepTimes { start_ns: 1_795_608_000_123_456_789, period_us: 1000 };
    let mut writer =
        SampleWriter::create(directory.path(), &signals, times, first, 100, &[]).expect("a file");
    for lateness in [Duration::from_nanos(1), Duration::from_secs(3), long] {
        let round_trip =
            Some(RoundTrip { send: lateness, line_and_device: long, compute: long, receive: long });
        let timing = StepTiming { lateness, outcome: StepOutcome::Answered, round_trip, tick_compute: None };
        let row = TraceRow {
            time_s: 0.0,
            reference_rad: 0.0,
            load_position_rad: 0.0,
            motor_position_rad: 0.0,
            torque_nm: 0.0,
        };
        let drive = DriveValues { values: [].into_iter().collect(), time_s: None };
        let step = Step { row, sample: None, plant: [].into_iter().collect(), drive, timing };
        writer.push(&step).expect("a step");
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
