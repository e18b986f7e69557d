//! Any of the laws with its state, in either precision.

use lashloop_firmware::control::backlash_inverse::BacklashInverse;
use lashloop_firmware::control::braking_curve::BrakingCurve;
use lashloop_firmware::control::cascade_signals::CascadeSignals;
use lashloop_firmware::control::merzouki::Merzouki;
use lashloop_firmware::control::pd::Pd;
use lashloop_firmware::law::{ControlOutput, Measurement, Real};

#[derive(Debug, Clone)]
pub(crate) enum Law<F: Real> {
    Pd(Pd<F>),
    Merzouki(Merzouki<F>),
    BacklashInverse(BacklashInverse<F>),
    BrakingCurve(BrakingCurve<F>),
}

impl<F: Real> Law<F> {
    pub(crate) fn step(&mut self, measurement: &Measurement<F>) -> ControlOutput<CascadeSignals<F>, F> {
        match self {
            Self::Pd(law) => law.step(measurement),
            Self::Merzouki(law) => law.step(measurement),
            Self::BacklashInverse(law) => law.step(measurement),
            Self::BrakingCurve(law) => {
                let ControlOutput { torque_nm, signals } = law.step(measurement);
                let signals = CascadeSignals {
                    dead_zone_estimate_rad: signals.dead_zone_estimate_rad,
                    disturbing_torque_estimate_nm: signals.disturbing_torque_estimate_nm,
                    load_error_rad: signals.load_error_rad,
                    motor_error_rad: signals.motor_error_rad,
                    elastic_error_nm: signals.elastic_error_nm,
                };
                ControlOutput { torque_nm, signals }
            }
        }
    }
}
