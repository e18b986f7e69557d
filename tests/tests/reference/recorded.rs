//! Trajectories computed by independent programs: every 10 ms for 25 s, true positions and velocities, no limit.
//!
//! `zoh_*` holds the torque for 1 ms, `cont_*` controls in continuous time; `*_bench_*` has no delay. The programs state their own error as at most
//! 1e-10 rad at the load and 7e-8 rad at the motor.

use crate::closed_loop::Row;

/// One recorded row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RecordedRow {
    pub(crate) time_s: f64,
    pub(crate) load_position_rad: f64,
    pub(crate) load_velocity_rad_s: f64,
    pub(crate) motor_position_rad: f64,
    pub(crate) motor_velocity_rad_s: f64,
    pub(crate) torque_nm: f64,
    pub(crate) dead_zone_estimate_rad: f64,
}

/// Reads `tests/data/reference/<name>.csv`.
pub(crate) fn read(name: &str) -> Vec<RecordedRow> {
    let path = format!("{}/data/reference/{name}.csv", env!("CARGO_MANIFEST_DIR"));
    let mut reader = csv::Reader::from_path(&path).expect("recorded trajectory is there");
    let rows: Vec<RecordedRow> = reader
        .records()
        .map(|record| {
            let record = record.expect("recorded trajectory is well-formed");
            let number = |column: usize| record[column].parse().expect("recorded trajectory holds numbers");
            RecordedRow {
                time_s: number(0),
                load_position_rad: number(1),
                load_velocity_rad_s: number(2),
                motor_position_rad: number(3),
                motor_velocity_rad_s: number(4),
                torque_nm: number(5),
                dead_zone_estimate_rad: number(6),
            }
        })
        .collect();
    assert_eq!(rows.len(), 2501, "{path}: have {} rows, want 2501", rows.len());
    rows
}

/// Largest differences between a computed and a recorded trajectory, over all recorded rows.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Difference {
    pub(crate) load_position_rad: f64,
    pub(crate) load_velocity_rad_s: f64,
    pub(crate) motor_position_rad: f64,
    pub(crate) motor_velocity_rad_s: f64,
    pub(crate) torque_nm: f64,
    pub(crate) dead_zone_estimate_rad: f64,
}

/// Compares row by row; every `stride`-th computed row has a recorded one.
pub(crate) fn difference(computed: &[Row], recorded: &[RecordedRow], stride: usize) -> Difference {
    let mut worst = Difference::default();
    let mut compared = 0;
    for (row, want) in computed.iter().step_by(stride).zip(recorded) {
        assert!((row.time_s - want.time_s).abs() < 1e-9, "row at {} s against {} s", row.time_s, want.time_s);
        let widen = |worst: &mut f64, have: f64, want: f64| *worst = worst.max((have - want).abs());
        widen(&mut worst.load_position_rad, row.truth.load_position_rad, want.load_position_rad);
        widen(&mut worst.load_velocity_rad_s, row.truth.load_velocity_rad_s, want.load_velocity_rad_s);
        widen(&mut worst.motor_position_rad, row.truth.motor_position_rad, want.motor_position_rad);
        widen(&mut worst.motor_velocity_rad_s, row.truth.motor_velocity_rad_s, want.motor_velocity_rad_s);
        widen(&mut worst.torque_nm, row.torque_nm, want.torque_nm);
        widen(&mut worst.dead_zone_estimate_rad, row.dead_zone_estimate_rad, want.dead_zone_estimate_rad);
        compared += 1;
    }
    assert_eq!(compared, recorded.len(), "compared {compared} of {} recorded rows", recorded.len());
    worst
}
