//! The cascade after compensation, as the paper prints it.
//!
//! Estimate and observer of equation (19), without lead of the motor position and without free control: an ablation
//! that shows the effect of those two.

use crate::control::cascade::{Cascade, CascadeGains, Compensation};
use crate::control::dead_zone::DeadZone;
use crate::control::dead_zone_observer::DeadZoneObserver;
use crate::control::nominal_model::NominalModel;
use crate::control::{ControlOutput, Controller, Measurement, ParameterError, Real};

/// The two loops with the estimated disturbing torque.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MerzoukiAsPrinted<F> {
    cascade: Cascade<F>,
    dead_zone: DeadZone<F>,
    observer: DeadZoneObserver<F>,
    period_s: F,
}

/// State of the law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MerzoukiAsPrintedState<F> {
    /// Dead-zone amplitude j_hat in rad, for the next torque.
    pub dead_zone_estimate_rad: F,
}

impl<F: Real> MerzoukiAsPrinted<F> {
    /// The law for the mechanics of `model`, run every `period_s` seconds.
    ///
    /// # Errors
    /// If the observer's parameters don't go together.
    pub fn new(
        model: &NominalModel<F>,
        gains: CascadeGains<F>,
        observer: DeadZoneObserver<F>,
        period_s: F,
    ) -> Result<Self, ParameterError> {
        observer.validate()?;
        Ok(Self { cascade: Cascade::new(model, gains), dead_zone: DeadZone::new(model), observer, period_s })
    }
}

impl<F: Real> Controller<F> for MerzoukiAsPrinted<F> {
    type State = MerzoukiAsPrintedState<F>;

    fn initial_state(&self) -> Self::State {
        MerzoukiAsPrintedState { dead_zone_estimate_rad: self.observer.initial_rad }
    }

    fn step(&self, state: &mut Self::State, measurement: &Measurement<F>) -> ControlOutput<F> {
        let twist = measurement.twist_rad;
        let estimate = state.dead_zone_estimate_rad;
        let compensation = Compensation {
            dead_zone_estimate_rad: estimate,
            disturbing_torque_nm: self.dead_zone.disturbing_torque_nm(estimate, twist),
            lead_rad: F::ZERO,
            free_torque_nm: F::ZERO,
        };
        let output = self.cascade.output(measurement, &compensation);
        self.observer.step(
            &mut state.dead_zone_estimate_rad,
            self.period_s,
            output.load_error_rad,
            output.elastic_error_nm,
            twist,
        );
        output
    }
}
