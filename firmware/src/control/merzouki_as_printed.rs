//! The adaptive law as the paper prints it: with the estimate of equation (19), but neither a lead nor a free control.
//!
//! An ablation of [`merzouki`](crate::control::merzouki) that shows the effect of those two; for comparison only.

use crate::control::cascade::{CascadeGains, LIVE_GAINS};
use crate::control::cascade_signals::CascadeSignals;
use crate::control::dead_zone_observer::{DeadZoneBounds, DeadZoneObserver};
use crate::control::merzouki::{DisturbingTorqueSource, Merzouki};
use crate::control::nominal_model::NominalModel;
use crate::law::{ControlLaw, ControlOutput, DriveParameters, Measurement, ParameterError};

/// The law without lead and without free control.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MerzoukiAsPrinted(Merzouki);

impl ControlLaw for MerzoukiAsPrinted {
    const NAME: &'static str = "merzouki-as-printed";
    type Parameters = (CascadeGains, DeadZoneObserver, DeadZoneBounds, NominalModel);
    type Signals = CascadeSignals;
    const LIVE: &'static [&'static str] = LIVE_GAINS;

    fn new(parameters: Self::Parameters, drive: &DriveParameters) -> Result<Self, ParameterError> {
        let (gains, observer, bounds, model) = parameters;
        let source = DisturbingTorqueSource::AsPrinted;
        Merzouki::new(&model, gains, observer, bounds, source, drive.period_s()).map(Self)
    }

    fn update(&mut self, (gains, ..): &Self::Parameters) -> Result<(), ParameterError> {
        self.0.set_gains(*gains);
        Ok(())
    }

    fn step(&mut self, measurement: &Measurement<f32>) -> ControlOutput<CascadeSignals> {
        self.0.step(measurement)
    }
}
