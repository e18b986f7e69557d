//! What a run leaves for the gate.

use lashloop_bench::run::Step;
use lashloop_record::columns::Columns;

/// Torques and positions of a run.
#[derive(Debug, Clone, Default)]
pub struct RecordedMotion {
    pub(super) torque_nm: Vec<f32>,
    /// Motor and load.
    pub(super) positions_rad: Vec<[f64; 2]>,
}

impl RecordedMotion {
    /// Takes a finished step.
    pub fn push(&mut self, step: &Step) {
        // The drive's own torque, which came as f32.
        self.torque_nm.push(step.row.torque_nm as f32);
        self.positions_rad.push([step.row.motor_position_rad, step.row.load_position_rad]);
    }

    /// The motion of a record; `None` if a column is missing.
    #[must_use]
    pub fn of(columns: &Columns) -> Option<Self> {
        let positions = columns.get("motor_position_rad")?.iter().zip(columns.get("load_position_rad")?);
        Some(Self {
            torque_nm: columns.get("torque_nm")?.iter().map(|&torque_nm| torque_nm as f32).collect(),
            positions_rad: positions.map(|(&motor, &load)| [motor, load]).collect(),
        })
    }
}
