//! Traces as bytes in a file.

use std::fs;
use std::path::{Path, PathBuf};

use super::{TraceRow, TraceWriter};
use crate::record::reader::Table;
use crate::record::row::Row;

fn row(step: u32) -> TraceRow {
    let value = f64::from(step);
    TraceRow {
        time_s: value * 0.001,
        reference_rad: 0.0,
        load_position_rad: std::f64::consts::FRAC_PI_2 / (value + 1.0),
        load_velocity_rad_s: -1.0 / 3.0,
        motor_position_rad: 1e-7 * value,
        motor_velocity_rad_s: -0.0,
        torque_nm: f64::from(0.1_f32),
        transmitted_torque_nm: 1e300,
        twist_rad: f64::MIN_POSITIVE,
        dead_zone_estimate_rad: 0.16,
        dead_zone_rad: 0.25,
        gap_position_rad: -0.25,
        contact: -1.0,
        motor_torque_nm: 2.0,
        load_torque_nm: 3.0,
        load_dry_friction_nm: 3.4,
        motor_dry_friction_nm: -0.02,
        load_sticks: 1.0,
        motor_sticks: 0.0,
        stored_energy_j: 0.5,
        supplied_energy_j: 0.75,
        dissipated_energy_j: 0.25,
        disturbing_torque_nm: -0.5,
        disturbing_torque_estimate_nm: -0.25,
        motor_error_rad: 0.125,
        estimate_time_s: value * 0.001,
    }
}

/// A trace file in a directory of its own.
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
    let (_directory, path) = place();
    let mut writer = TraceWriter::create(&path, 1000).expect("a trace");
    writer.push(&row(0)).expect("a row");
    writer.push(&TraceRow { torque_nm: f64::NAN, ..row(1) }).expect("a row");
    writer.finish().expect("the rows");
    insta::assert_snapshot!(fs::read_to_string(&path).expect("a trace"), @r#"
    time_s,reference_rad,load_position_rad,load_velocity_rad_s,motor_position_rad,motor_velocity_rad_s,torque_nm,transmitted_torque_nm,twist_rad,dead_zone_estimate_rad,dead_zone_rad,gap_position_rad,contact,motor_torque_nm,load_torque_nm,load_dry_friction_nm,motor_dry_friction_nm,load_sticks,motor_sticks,stored_energy_j,supplied_energy_j,dissipated_energy_j,disturbing_torque_nm,disturbing_torque_estimate_nm,motor_error_rad,estimate_time_s
    0.0,0.0,1.5707963267948966,-0.3333333333333333,0.0,-0.0,0.10000000149011612,1e+300,2.2250738585072014e-308,0.16,0.25,-0.25,-1.0,2.0,3.0,3.4,-0.02,1.0,0.0,0.5,0.75,0.25,-0.5,-0.25,0.125,0.0
    0.001,0.0,0.7853981633974483,-0.3333333333333333,1e-7,-0.0,NaN,1e+300,2.2250738585072014e-308,0.16,0.25,-0.25,-1.0,2.0,3.0,3.4,-0.02,1.0,0.0,0.5,0.75,0.25,-0.5,-0.25,0.125,0.001
    "#);
}

#[test]
fn numbers_read_back_to_the_same_bits() {
    let (_directory, path) = place();
    let mut writer = TraceWriter::create(&path, 7).expect("a trace");
    (0..100).for_each(|step| writer.push(&row(step)).expect("a row"));
    writer.finish().expect("the rows");
    let rows = TraceRow::read(&Table::read(&path).expect("a trace")).expect("every column");
    assert_eq!(rows.len(), 100);
    for (step, have) in (0..).zip(rows) {
        let want: Vec<_> = row(step).values().map(f64::to_bits).collect();
        assert_eq!(have.values().map(f64::to_bits).collect::<Vec<_>>(), want, "step {step}");
    }
}

#[test]
fn rows_reach_the_file_whole_and_flush_rows_at_a_time() {
    let (_directory, path) = place();
    let mut writer = TraceWriter::create(&path, 10).expect("a trace");
    for step in 0..25 {
        writer.push(&row(step)).expect("a row");
        assert_eq!(data_rows(&path), (step as usize + 1) / 10 * 10, "after step {step}");
    }
    drop(writer);
    assert_eq!(data_rows(&path), 25);
}

#[test]
fn an_existing_trace_is_replaced() {
    let (_directory, path) = place();
    fs::write(&path, "x".repeat(10_000)).expect("an old trace");
    TraceWriter::create(&path, 1).and_then(TraceWriter::finish).expect("a trace");
    assert_eq!(data_rows(&path), 0);
}

#[test]
fn a_file_that_cannot_be_made_is_named() {
    let error = TraceWriter::create(Path::new("no/such/trace.csv"), 1).expect_err("no directory");
    assert_eq!(
        error.to_string(),
        "no/such/trace.csv: cannot be created: No such file or directory (os error 2)"
    );
}

/// `/dev/full` refuses every byte, as a full disk does.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_reported_with_the_path() {
    let error = TraceWriter::create(Path::new("/dev/full"), 1).expect_err("a full disk");
    assert_eq!(error.to_string(), "/dev/full: cannot be written: No space left on device (os error 28)");
}
