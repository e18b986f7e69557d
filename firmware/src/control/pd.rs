//! The cascade before compensation: "only a PD controller".
//!
//! No estimate of the disturbing torque, no lead, no free control. The elastic feedback k1 stays: only with it do the
//! paper's 13 s and its static error of 0.32 rad result.
//!
//! Section 17 of docs/protocol.md specifies this law with its sensing as the profile `pd`, operation by operation, and
//! `protocol/golden/pd.csv` has its torques under a moving reference: a change of one bit here changes both.

use crate::control::cascade::{Cascade, CascadeGains, Compensation, LIVE_GAINS};
use crate::control::cascade_signals::CascadeSignals;
use crate::control::nominal_model::NominalModel;
use crate::law::{ControlLaw, ControlOutput, DriveParameters, Measurement, ParameterError, Real};

/// The two loops alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pd<F = f32> {
    cascade: Cascade<F>,
    nominal_dead_zone_rad: F,
}

impl<F: Real> Pd<F> {
    /// The law for the mechanics of `model`.
    pub fn new(model: &NominalModel<F>, gains: CascadeGains<F>) -> Self {
        Self { cascade: Cascade::new(model, gains), nominal_dead_zone_rad: model.dead_zone_rad }
    }

    /// The torque for one sample, before the drive's limit.
    pub fn step(&self, measurement: &Measurement<F>) -> ControlOutput<CascadeSignals<F>, F> {
        let none = Compensation {
            dead_zone_estimate_rad: self.nominal_dead_zone_rad,
            disturbing_torque_nm: F::ZERO,
            lead_rad: F::ZERO,
            free_torque_nm: F::ZERO,
        };
        self.cascade.output(measurement, &none)
    }
}

impl ControlLaw for Pd {
    const NAME: &'static str = "pd";
    type Parameters = (CascadeGains, NominalModel);
    type Signals = CascadeSignals;
    const LIVE: &'static [&'static str] = LIVE_GAINS;

    fn new((gains, model): Self::Parameters, _drive: &DriveParameters) -> Result<Self, ParameterError> {
        Ok(Self::new(&model, gains))
    }

    fn update(&mut self, (gains, _): &Self::Parameters) -> Result<(), ParameterError> {
        self.cascade.set_gains(*gains);
        Ok(())
    }

    fn step(&mut self, measurement: &Measurement<f32>) -> ControlOutput<CascadeSignals> {
        Self::step(self, measurement)
    }
}
