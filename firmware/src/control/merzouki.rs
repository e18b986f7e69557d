//! The cascade after compensation, in the reading that meets the paper's figures.
//!
//! The paper leaves the free control u of equation (16) open. With u = w - w_hat, equation (24) with H = 0, and a lead
//! of the motor by zeta_d / K, as (13) and (18) imply, both the simulated transients and the measured static error of
//! the paper result. With a constant reference zeta_d / K is -w_hat / K. Under a slow sine the reference's part of
//! zeta_d in the lead moves the motor ahead of the dead zone: lost motion is 0.003 instead of 0.13 rad on the hard gap.
//!
//! On the paper's smooth plant equation (4) gives the disturbing torque w. On any other plant w is observed:
//! w = C_obs - K z with the momentum observer's C_obs.

use crate::control::cascade::{Cascade, CascadeGains, Compensation, LIVE_GAINS};
use crate::control::cascade_signals::CascadeSignals;
use crate::control::dead_zone::DeadZone;
use crate::control::dead_zone_observer::{DeadZoneBounds, DeadZoneObserver};
use crate::control::feed_forward::FeedForward;
use crate::control::momentum_observer::{MomentumObserver, MomentumObserverPole};
use crate::control::nominal_model::NominalModel;
use crate::law::{ControlLaw, ControlOutput, DriveParameters, Measurement, ParameterError, Real};

crate::choices! {
    /// Source of the disturbing torque, as the host sets it.
    pub enum SourceChoice {
        /// Equation (4) with the nominal amplitude.
        Model = "model",
        /// The momentum observer.
        Observed = "observed",
    }
}

crate::parameters! {
    /// Setting of the compensation.
    pub struct MerzoukiSetting {
        /// Source of the disturbing torque.
        disturbing_torque_source: SourceChoice = Observed;
    }
}

/// Source of the disturbing torque w for the free control.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DisturbingTorqueSource<F> {
    /// None: the law as printed, without lead and without free control.
    AsPrinted,
    /// Equation (4) with the nominal amplitude: valid on the paper's smooth plant only.
    NominalModel,
    /// The momentum observer on the motor side, valid on any plant. A pole of 60 rad/s suits the paper's machine.
    Observed(MomentumObserver<F>),
}

/// The two loops with the estimated disturbing torque, the lead and the free control, and their state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Merzouki<F = f32> {
    cascade: Cascade<F>,
    feed_forward: FeedForward<F>,
    dead_zone: DeadZone<F>,
    model: NominalModel<F>,
    observer: DeadZoneObserver<F>,
    bounds: DeadZoneBounds<F>,
    source: DisturbingTorqueSource<F>,
    period_s: F,
    /// Dead-zone amplitude j_hat in rad, for the next torque.
    dead_zone_estimate_rad: F,
    /// State of the momentum observer: zero unless the law observes the disturbing torque.
    momentum_balance_nm: F,
}

impl<F: Real> Merzouki<F> {
    /// The law in its initial state, for the mechanics of `model`, run every `period_s` seconds.
    ///
    /// # Errors
    /// If the initial estimate is beyond its upper bound.
    pub fn new(
        model: &NominalModel<F>,
        gains: CascadeGains<F>,
        observer: DeadZoneObserver<F>,
        bounds: DeadZoneBounds<F>,
        source: DisturbingTorqueSource<F>,
        period_s: F,
    ) -> Result<Self, ParameterError> {
        bounds.validate()?;
        Ok(Self {
            cascade: Cascade::new(model, gains),
            feed_forward: FeedForward::new(model),
            dead_zone: DeadZone::new(model),
            model: *model,
            observer,
            bounds,
            source,
            period_s,
            dead_zone_estimate_rad: bounds.dead_zone_initial_rad,
            momentum_balance_nm: F::ZERO,
        })
    }

    /// Replaces the gains of the cascade.
    pub fn set_gains(&mut self, gains: CascadeGains<F>) {
        self.cascade.set_gains(gains);
    }

    /// The torque for one sample, before the drive's limit.
    pub fn step(&mut self, measurement: &Measurement<F>) -> ControlOutput<CascadeSignals<F>, F> {
        let twist = measurement.twist_rad;
        let observed_torque = match &self.source {
            DisturbingTorqueSource::AsPrinted => None,
            DisturbingTorqueSource::NominalModel => {
                Some(self.dead_zone.disturbing_torque_nm(self.model.dead_zone_rad, twist))
            }
            DisturbingTorqueSource::Observed(observer) => Some(
                observer.step(&mut self.momentum_balance_nm, measurement)
                    - self.model.stiffness_nm_rad * twist,
            ),
        };
        let estimate = self.dead_zone_estimate_rad;
        let estimated_torque = self.dead_zone.disturbing_torque_nm(estimate, twist);
        let (lead_rad, free_torque_nm) = match observed_torque {
            None => (F::ZERO, F::ZERO),
            Some(observed_torque) => {
                let wanted_elastic_torque =
                    self.feed_forward.elastic_torque_nm(measurement) - estimated_torque;
                (wanted_elastic_torque / self.model.stiffness_nm_rad, observed_torque - estimated_torque)
            }
        };
        let compensation = Compensation {
            dead_zone_estimate_rad: estimate,
            disturbing_torque_nm: estimated_torque,
            lead_rad,
            free_torque_nm,
        };
        let output = self.cascade.output(measurement, &compensation);
        self.observer.step(
            &mut self.dead_zone_estimate_rad,
            &self.bounds,
            self.period_s,
            output.signals.load_error_rad,
            output.signals.elastic_error_nm,
            twist,
        );
        output
    }
}

impl ControlLaw for Merzouki {
    const NAME: &'static str = "merzouki";
    type Parameters =
        (CascadeGains, DeadZoneObserver, DeadZoneBounds, MerzoukiSetting, MomentumObserverPole, NominalModel);
    type Signals = CascadeSignals;
    const LIVE: &'static [&'static str] = LIVE_GAINS;

    fn new(parameters: Self::Parameters, drive: &DriveParameters) -> Result<Self, ParameterError> {
        let (gains, observer, bounds, setting, pole, model) = parameters;
        let source = match setting.disturbing_torque_source {
            SourceChoice::Model => DisturbingTorqueSource::NominalModel,
            SourceChoice::Observed => DisturbingTorqueSource::Observed(MomentumObserver::new(
                &model,
                pole.momentum_observer_rad_s,
                drive.period_s(),
            )),
        };
        Self::new(&model, gains, observer, bounds, source, drive.period_s())
    }

    fn update(&mut self, (gains, ..): &Self::Parameters) -> Result<(), ParameterError> {
        self.set_gains(*gains);
        Ok(())
    }

    fn step(&mut self, measurement: &Measurement<f32>) -> ControlOutput<CascadeSignals> {
        Self::step(self, measurement)
    }
}
