//! Faults of the motor.

use serde::Serialize;

use crate::scenario::declare::{integer, number};
use crate::settings;

settings! {
    /// Faults between the torque the drive commands and the torque the motor gives.
    #[derive(Debug, Clone, Copy, PartialEq, Serialize)]
    #[serde(tag = "kind")]
    pub enum MotorFault {
        /// The motor's torque is limited.
        "torque-saturation" => Saturation {
            /// Limit of the magnitude.
            limit_nm: f64 = number(0.0..=1e6),
        },
        /// The motor's torque is the commanded one times a gain.
        "torque-gain" => Gain {
            /// The gain; negative for a motor that is wired with reversed polarity.
            gain: f64 = number(-1e3..=1e3),
        },
        /// The motor's torque is the one commanded some steps earlier.
        "torque-delay" => Delay {
            /// Delay in control steps.
            steps: u32 = integer(1..=1_000),
        },
        /// The motor gives no torque.
        "torque-dead" => Dead {},
    }
}
