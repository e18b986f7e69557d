//! Rounds of a comparison.

/// One round of one plant on one side.
#[derive(Debug, Clone, Copy)]
pub struct Round {
    /// Wall-clock time.
    pub ns: f64,
    /// Final positions of load and motor.
    pub ends_rad: [f64; 2],
}

/// The middle value; the upper one of two.
pub fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
