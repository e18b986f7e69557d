//! One sample of a run.

/// The drive's estimates at one sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimates {
    /// Estimate of j0, half the gap.
    pub dead_zone_rad: f64,
    /// Estimate of the disturbing torque w = C - K z.
    pub disturbing_torque_nm: f64,
}

/// Input of the metrics from one control step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Time since the start of the run.
    pub time_s: f64,
    /// Reference position at that time.
    pub reference_rad: f64,
    /// True position of the load at that time.
    pub load_position_rad: f64,
    /// Torque that is held for one period from that time on.
    pub torque_nm: f64,
    /// The drive's estimates of that time; `None` for a step without telemetry.
    pub estimates: Option<Estimates>,
    /// True j0 at that time.
    pub dead_zone_rad: f64,
    /// True disturbing torque at that time.
    pub disturbing_torque_nm: f64,
}
