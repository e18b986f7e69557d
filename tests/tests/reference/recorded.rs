//! Trajectories computed by independent programs: true positions and velocities of 25 s, without a torque limit.
//!
//! `zoh_*` holds the torque for 1 ms, `cont_*` controls in continuous time; `zoh_bench_pd` is the backlash shaft without
//! delay. The programs state their own error as at most 1e-10 rad at the load and 7e-8 rad at the motor.
//!
//! The programs wrote a row every 10 ms. We keep every row of the first second, the approach; after it a row every
//! 250 ms and, of every 500 ms, the row with the fastest motor, where the load breaks away and the gap is crossed. The
//! rows themselves are as the programs wrote them.

use crate::trajectory::Row;

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
    let mut reader = csv::Reader::from_path(&path).expect("the recorded trajectory exists");
    let rows: Vec<RecordedRow> = reader
        .records()
        .map(|record| {
            let record = record.expect("the recorded trajectory is well-formed");
            let number =
                |column: usize| record[column].parse().expect("the recorded trajectory holds numbers");
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
    assert!(rows.len() >= 199, "{path}: have {} rows, want at least 199", rows.len());
    assert_eq!(rows.last().map(|row| row.time_s), Some(25.0), "{path}: the last row is at 25 s");
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

/// Compares every recorded row with the computed row of its time; computed rows are `spacing_s` apart.
pub(crate) fn difference(computed: &[Row], recorded: &[RecordedRow], spacing_s: f64) -> Difference {
    let mut worst = Difference::default();
    for want in recorded {
        let row = &computed[(want.time_s / spacing_s).round() as usize];
        assert!((row.time_s - want.time_s).abs() < 1e-9, "row at {} s against {} s", row.time_s, want.time_s);
        // `max` would drop a NaN.
        let widen = |worst: &mut f64, have: f64, want: f64| {
            let difference = (have - want).abs();
            assert!(!difference.is_nan(), "NaN at {} s", row.time_s);
            *worst = worst.max(difference);
        };
        widen(&mut worst.load_position_rad, row.truth.load_position_rad, want.load_position_rad);
        widen(&mut worst.load_velocity_rad_s, row.truth.load_velocity_rad_s, want.load_velocity_rad_s);
        widen(&mut worst.motor_position_rad, row.truth.motor_position_rad, want.motor_position_rad);
        widen(&mut worst.motor_velocity_rad_s, row.truth.motor_velocity_rad_s, want.motor_velocity_rad_s);
        widen(&mut worst.torque_nm, row.torque_nm, want.torque_nm);
        widen(&mut worst.dead_zone_estimate_rad, row.dead_zone_estimate_rad, want.dead_zone_estimate_rad);
    }
    worst
}
