//! What a host allows of the power stage.

/// How a power stage turns on for the checks of bench mode.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PowerStage {
    /// Torque in N m for a duty of 1 more than that of no torque; `None` for the largest that the drive takes, so that its duty
    /// is next to that of no torque.
    pub torque_per_duty_nm: Option<f32>,
}
