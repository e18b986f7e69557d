//! Traces as bytes in a file.

use std::fs;
use std::path::{Path, PathBuf};

use super::{TraceRow, TraceWriter, columns};
use crate::columns::Columns;
use crate::reader::{Record, Table};
use crate::row::Row;
use crate::table::TableWriter;
use lashloop_plant::Signal;
use lashloop_plant::metrics::SignalTable;

fn signals() -> SignalTable {
    SignalTable {
        plant: vec![Signal::new("twist_rad", "rad"), Signal::new("middle mass, speed", "rad/s")],
        drive: vec![Signal::new("requested_torque_nm", "N m"), Signal::new("backlash", "")],
    }
}

fn row(step: u32) -> Vec<f64> {
    let value = f64::from(step);
    let fixed = TraceRow {
        time_s: value * 0.001,
        reference_rad: 0.0,
        load_position_rad: std::f64::consts::FRAC_PI_2 / (value + 1.0),
        motor_position_rad: 1e-7 * value,
        torque_nm: f64::from(0.1_f32),
    };
    let values = [f64::MIN_POSITIVE, -1.0 / 3.0, 1e300, -0.0, value * 0.001];
    fixed.values().chain(values).collect()
}

/// A folder for the record of a run, and the path of its trace.
fn place() -> (tempfile::TempDir, PathBuf) {
    let directory = tempfile::tempdir().expect("a temporary directory");
    let path = directory.path().join("trace.csv");
    (directory, path)
}

fn data_rows(path: &Path) -> usize {
    let text = fs::read_to_string(path).expect("a trace");
    assert!(text.ends_with('\n'), "a torn row: {:?}", text.lines().last());
    text.lines().count() - 1
}

#[test]
fn a_trace_is_a_header_and_one_line_per_step() {
    let (directory, path) = place();
    let mut writer = TraceWriter::create(directory.path(), &signals(), 1000).expect("a trace");
    writer.push(row(0)).expect("a row");
    let mut unknown = row(1);
    unknown[4] = f64::NAN;
    writer.push(unknown).expect("a row");
    writer.finish().expect("the rows");
    insta::assert_snapshot!(fs::read_to_string(&path).expect("a trace"), @r#"
    time_s,reference_rad,load_position_rad,motor_position_rad,torque_nm,twist_rad,"middle mass, speed",drive.requested_torque_nm,drive.backlash,telemetry_time_s
    0.0,0.0,1.5707963267948966,0.0,0.10000000149011612,2.2250738585072014e-308,-0.3333333333333333,1e+300,-0.0,0.0
    0.001,0.0,0.7853981633974483,1e-7,NaN,2.2250738585072014e-308,-0.3333333333333333,1e+300,-0.0,0.001
    "#);
}

#[test]
fn columns_read_back_with_their_units() {
    let (directory, path) = place();
    let mut writer = TraceWriter::create(directory.path(), &signals(), 1).expect("a trace");
    writer.push(row(0)).expect("a row");
    drop(writer);
    let trace = Record::read(directory.path()).expect("a record").trace;
    assert_eq!(trace.columns.signals(), super::columns(&signals()));
    let units = ["time_s", "middle mass, speed", "drive.requested_torque_nm", "drive.backlash"];
    assert_eq!(units.map(|name| trace.columns.unit(name)), [Some("s"), Some("rad/s"), Some("N m"), Some("")]);

    // The trace alone has no units, and a damaged list is an error of its own.
    assert_eq!(Table::read(&path).expect("a table").columns.unit("time_s"), Some(""));
    fs::write(directory.path().join("trace.json"), "{").expect("a damaged list");
    let error = Record::read(directory.path()).expect_err("a damaged list").to_string();
    assert!(error.contains("trace.json: is not the list of a trace's columns: "), "{error}");
}

#[test]
fn numbers_read_back_to_the_same_bits() {
    let (directory, path) = place();
    let mut writer = TraceWriter::create(directory.path(), &signals(), 7).expect("a trace");
    let mut written = Columns::new(super::columns(&signals()));
    for step in 0..100 {
        writer.push(row(step)).expect("a row");
        written.push(row(step));
    }
    writer.finish().expect("the rows");
    let read = Table::read(&path).expect("a trace").columns;
    assert_eq!(read.len(), 100);
    for Signal { name, .. } in written.signals() {
        let bits = |columns: &Columns| -> Vec<u64> {
            columns.get(name).expect("the column").iter().map(|value| value.to_bits()).collect()
        };
        assert_eq!(bits(&read), bits(&written), "{name}");
    }
}

#[test]
fn rows_reach_the_file_whole_and_flush_rows_at_a_time() {
    let (directory, path) = place();
    let mut writer = TraceWriter::create(directory.path(), &signals(), 10).expect("a trace");
    for step in 0..25 {
        writer.push(row(step)).expect("a row");
        assert_eq!(data_rows(&path), (step as usize + 1) / 10 * 10, "after step {step}");
    }
    drop(writer);
    assert_eq!(data_rows(&path), 25);
}

#[test]
fn an_existing_trace_is_replaced() {
    let (directory, path) = place();
    fs::write(&path, "x".repeat(10_000)).expect("an old trace");
    TraceWriter::create(directory.path(), &signals(), 1).and_then(TraceWriter::finish).expect("a trace");
    assert_eq!(data_rows(&path), 0);
}

#[test]
fn a_file_that_cannot_be_made_is_named() {
    let error = TraceWriter::create(Path::new("no/such"), &signals(), 1).expect_err("no directory");
    assert_eq!(
        error.to_string(),
        "no/such/trace.json: cannot be created: No such file or directory (os error 2)"
    );
}

/// `/dev/full` refuses every byte, as a full disk does.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_reported_with_the_path() {
    let error = TableWriter::create(Path::new("/dev/full"), ["time_s"], 1).expect_err("a full disk");
    assert_eq!(error.to_string(), "/dev/full: cannot be written: No space left on device (os error 28)");
}

#[test]
fn a_plant_may_take_none_of_the_columns_of_every_trace() {
    let columns = columns(&SignalTable::default());
    let names: Vec<_> = columns.iter().map(|column| &*column.name).collect();
    assert_eq!(names, lashloop_plant::FIXED_COLUMNS);
    // Between the two times: what expectations may name in every run, with the same units.
    assert_eq!(columns[1..columns.len() - 1], lashloop_plant::metrics::FIXED_SIGNALS);
}
