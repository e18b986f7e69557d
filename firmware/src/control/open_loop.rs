//! The reference as a torque, without feedback.
//!
//! Commissioning excites an unknown drive train by it, because no loop can be closed before the directions of the
//! encoders are known. The limits of the drive apply: torque, speeds, watchdog.

use crate::law::{ControlLaw, ControlOutput, DriveParameters, Measurement, ParameterError};

crate::parameters! {
    /// Scale of the reference.
    pub struct OpenLoopGain {
        /// Torque for a reference of 1 rad.
        torque_per_rad_nm: F32 = 1.0 in 0.0..=1e6, "N m/rad";
    }
}

/// U = k r.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OpenLoop {
    torque_per_rad_nm: f32,
}

impl ControlLaw for OpenLoop {
    const NAME: &'static str = "open-loop";
    const TAKES_TORQUE: bool = true;
    type Parameters = OpenLoopGain;
    type Signals = ();

    fn new(gain: OpenLoopGain, _drive: &DriveParameters) -> Result<Self, ParameterError> {
        Ok(Self { torque_per_rad_nm: gain.torque_per_rad_nm })
    }

    fn step(&mut self, measurement: &Measurement<f32>) -> ControlOutput<()> {
        ControlOutput { torque_nm: self.torque_per_rad_nm * measurement.reference_position_rad, signals: () }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn torque_follows_the_reference_and_nothing_else() {
        let mut law = OpenLoop { torque_per_rad_nm: 2.5 };
        for reference_position_rad in [0.0, 1.5, -4.0] {
            let moving = Measurement {
                reference_position_rad,
                motor_position_rad: 7.0,
                motor_velocity_rad_s: -300.0,
                load_position_rad: 2.0,
                load_velocity_rad_s: 5.0,
                twist_rad: 1.0,
                reference_velocity_rad_s: 11.0,
                reference_acceleration_rad_s2: -13.0,
                applied_torque_nm: 3.0,
            };
            assert_eq!(law.step(&moving).torque_nm, 2.5 * reference_position_rad);
        }
    }
}
