//! One sample of a run.

/// Input of the metrics from one control step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample<'a> {
    /// Time since the start of the run.
    pub time_s: f64,
    /// Reference position at that time.
    pub reference_rad: f64,
    /// True position of the load at that time.
    pub load_position_rad: f64,
    /// True position of the motor at that time.
    pub motor_position_rad: f64,
    /// Torque that is held for one period from that time on.
    pub torque_nm: f64,
    /// The plant's signals at that time, in the order of [`SignalTable::plant`](super::SignalTable::plant).
    pub plant: &'a [f64],
    /// The drive's signals of this very sample, in the order of [`SignalTable::drive`](super::SignalTable::drive); `None` for
    /// a step without telemetry. Values that are repeated until the next telemetry don't belong here.
    pub drive: Option<&'a [f64]>,
}

impl Sample<'_> {
    /// The values of [`FIXED_SIGNALS`](super::FIXED_SIGNALS), in their order.
    pub(super) const fn fixed(&self) -> [f64; 4] {
        [self.reference_rad, self.load_position_rad, self.motor_position_rad, self.torque_nm]
    }
}
