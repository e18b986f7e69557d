//! What is known of the parameters before any motion.
//!
//! The prior of a parameter of the drive train only keeps the fit from wandering where the motion excites nothing: its
//! standard deviation is a factor of 4 for most, and an interval is reported only where the motion itself is the source.
//!
//! The prior of an encoder's eccentricity is what is stated of the encoder. A motion of far less than a turn shows an
//! eccentric encoder as a wrong scale; the prior then carries the stated error into every interval that the scale is in.

use crate::parameters::{COUNT, Parameter};
use crate::series::Instruments;

/// Standard deviation of offset and cogging of the torque, as a fraction of the largest torque.
const OF_TORQUE: f64 = 0.05;
/// Standard deviations in the stated error of an encoder, which is a limit. Half an interval has 3.2 of them.
const IN_LIMIT: f64 = 2.0;

/// Standard deviation of each parameter around its start, in the scale of the vector. 0 is a parameter that is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Prior([f64; COUNT]);

impl Prior {
    /// `peak_nm` is the largest torque of the motions.
    pub(crate) fn new(instruments: &Instruments, peak_nm: f64) -> Self {
        let [motor_rad, load_rad] = instruments.encoder_error_rad.map(|limit_rad| limit_rad / IN_LIMIT);
        Self(Parameter::ALL.map(|it| match it {
            Parameter::MotorExcess | Parameter::LoadExcess | Parameter::LoadAsymmetry => 0.3,
            Parameter::MotorStribeck | Parameter::LoadStribeck | Parameter::CurrentLag => 0.7,
            Parameter::TorqueOffset | Parameter::CoggingCosine | Parameter::CoggingSine => {
                OF_TORQUE * peak_nm
            }
            Parameter::MotorCosine | Parameter::MotorSine => motor_rad,
            Parameter::LoadCosine | Parameter::LoadSine => load_rad,
            _ => 1.4,
        }))
    }

    pub(crate) fn deviation(&self, parameter: Parameter) -> f64 {
        self.0[parameter as usize]
    }

    /// The parameters of these that aren't known.
    pub(crate) fn free(&self, of: impl Fn(Parameter) -> bool) -> [bool; COUNT] {
        Parameter::ALL.map(|it| of(it) && self.deviation(it) > 0.0)
    }

    /// Difference of an element for a derivative.
    pub(crate) fn step(&self, parameter: Parameter) -> f64 {
        const OF_DEVIATION: f64 = 1e-3;
        const OF_ELEMENT: f64 = 1e-4;
        if parameter.is_error() { OF_DEVIATION * self.deviation(parameter) } else { OF_ELEMENT }
    }
}
