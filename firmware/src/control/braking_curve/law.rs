//! The law: load loop, winding, inverse of the gap, and identification of the gap.

use super::gains::BrakingCurveGains;
use super::load_loop::{LoadLoop, LoadLoopState};
use super::signals::BrakingCurveSignals;
use super::winding::{Winding, WindingState};
use crate::control::dead_zone_observer::DeadZoneBounds;
use crate::control::gap_identification::{Estimate, GAP_PROCESS_NOISE_RAD2, Identification, mean_misfit_rad};
use crate::control::lag::alpha;
use crate::control::load_observer::{LoadObserver, LoadObserverState};
use crate::control::momentum_observer::MomentumObserver;
use crate::control::motor_friction::MotorFriction;
use crate::control::nominal_model::NominalModel;
use crate::law::{ControlLaw, ControlOutput, DriveParameters, Measurement, ParameterError, Real};

/// Periods in a row with a balanced motor before a sample counts for the gap.
const BALANCED_PERIODS: u32 = 19;
/// Torque of the motor's acceleration, and rate of the twist, up to which it is balanced.
const BALANCE_NM: f64 = 0.6;
const BALANCE_RAD_S: f64 = 4.0;

/// Largest `dead_zone_deviation_rad` in rad with which the gap counts as learnt.
pub const LEARNT_DEVIATION_RAD: f64 = 0.015;

/// What the law needs of the drive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BrakingCurveSetting<F> {
    /// Start and upper bound of the dead-zone estimate.
    pub dead_zone: DeadZoneBounds<F>,
    /// One count of the load encoder in rad.
    pub load_resolution_rad: F,
    /// Torque limit of the drive in N m.
    pub torque_limit_nm: F,
    /// Control period in seconds.
    pub period_s: F,
}

/// The law with its constants and its state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BrakingCurve<F: Real = f32> {
    model: NominalModel<F>,
    gains: BrakingCurveGains<F>,
    load_loop: LoadLoop<F>,
    winding: Winding<F>,
    momentum: MomentumObserver<F>,
    load_observer: LoadObserver<F>,
    identification: Identification<F>,
    per_crossing_nm: F,
    twist_alpha: F,
    estimate: Estimate<F>,
    load_loop_state: LoadLoopState<F>,
    winding_state: WindingState<F>,
    momentum_balance_nm: F,
    balanced_periods: u32,
    misfit_rad: F,
    /// `None` before the first sample.
    observers: Option<Observers<F>>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Observers<F> {
    load: LoadObserverState<F>,
    motor_friction: MotorFriction<F>,
    /// The twist behind the lag of the momentum observer, so that both belong to the same instant.
    twist_rad: F,
}

impl<F: Real> BrakingCurve<F> {
    /// The law in its initial state, for the mechanics of `model`.
    ///
    /// # Errors
    /// If gains don't go with the period, the motor's inertia or each other.
    pub fn new(
        model: &NominalModel<F>,
        gains: BrakingCurveGains<F>,
        setting: BrakingCurveSetting<F>,
    ) -> Result<Self, ParameterError> {
        let BrakingCurveSetting { dead_zone, load_resolution_rad, torque_limit_nm, period_s } = setting;
        gains.validate(model.motor_inertia_kg_m2, period_s)?;
        dead_zone.validate()?;
        let identification = Identification {
            nominal_rad_nm: F::ONE / model.stiffness_nm_rad,
            initial_rad: dead_zone.dead_zone_initial_rad,
            max_rad: dead_zone.dead_zone_max_rad,
            min_torque_nm: gains.learning_min_nm,
            process_noise_rad2: F::from_f64(GAP_PROCESS_NOISE_RAD2),
        };
        Ok(Self {
            model: *model,
            gains,
            load_loop: LoadLoop::new(model, gains, load_resolution_rad, torque_limit_nm, period_s),
            winding: Winding {
                pole_rad_s: gains.winding_rad_s,
                speed_limit_rad_s: gains.winding_speed_rad_s,
                period_s,
            },
            momentum: MomentumObserver::new(model, gains.shaft_observer_rad_s, period_s),
            load_observer: LoadObserver::new(model, gains.speed_observer_rad_s, period_s),
            identification,
            per_crossing_nm: F::ONE / gains.crossing_nm,
            twist_alpha: alpha(gains.shaft_observer_rad_s, period_s),
            estimate: identification.initial_estimate(),
            load_loop_state: LoadLoop::initial_state(),
            winding_state: Winding::initial_state(),
            momentum_balance_nm: F::ZERO,
            balanced_periods: 0,
            misfit_rad: F::ZERO,
            observers: None,
        })
    }

    /// The torque for one sample, before the drive's limit.
    pub fn step(&mut self, measurement: &Measurement<F>) -> ControlOutput<BrakingCurveSignals<F>, F> {
        let m = measurement;
        let observers = self.observers.get_or_insert_with(|| Observers {
            load: LoadObserver::initial_state(m.load_position_rad),
            motor_friction: MotorFriction::at(m.motor_position_rad),
            twist_rad: m.twist_rad,
        });
        let gains = &self.gains;

        let coulomb_nm = self.model.motor_coulomb_nm * observers.motor_friction.step(m.motor_position_rad);
        let transmitted_nm = self.momentum.step_against(&mut self.momentum_balance_nm, m, coulomb_nm);
        let load_velocity = self.load_observer.step(&mut observers.load, m.load_position_rad, transmitted_nm);

        let behind_rad = m.twist_rad - observers.twist_rad;
        observers.twist_rad += self.twist_alpha * behind_rad;
        let lagging_twist = observers.twist_rad;
        let viscous_nm = self.model.motor_friction_nm_s_rad * m.motor_velocity_rad_s;
        let accelerating_nm = m.applied_torque_nm - viscous_nm - coulomb_nm - transmitted_nm;
        let twist_rate = gains.shaft_observer_rad_s * (m.twist_rad - lagging_twist);
        let balanced =
            accelerating_nm.abs() < F::from_f64(BALANCE_NM) && twist_rate.abs() < F::from_f64(BALANCE_RAD_S);
        self.balanced_periods = if balanced { (self.balanced_periods + 1).min(BALANCED_PERIODS) } else { 0 };
        if !self.load_loop_state.holding && self.balanced_periods == BALANCED_PERIODS {
            let error =
                self.identification.step(&mut self.estimate, transmitted_nm, lagging_twist, twist_rate);
            self.misfit_rad = error.map_or(self.misfit_rad, |error| mean_misfit_rad(self.misfit_rad, error));
        }

        let load = observers.load.observed(transmitted_nm);
        let commanded_nm = self.load_loop.step(&mut self.load_loop_state, m, &load);
        let compliance = self.estimate.compliance_rad_nm();
        let dead_zone = self.estimate.dead_zone_rad();
        let winding_nm_s2 = self.winding.step(&mut self.winding_state, commanded_nm, compliance);
        let WindingState { torque_nm: wound_nm, rate_nm_s } = self.winding_state;
        let side = (self.per_crossing_nm * wound_nm).clamp(-F::ONE, F::ONE);
        let twist_error = m.twist_rad - (compliance * wound_nm + dead_zone * side);
        let twist_velocity =
            m.motor_velocity_rad_s - self.model.reduction_ratio * load_velocity - compliance * rate_nm_s;
        let torque = wound_nm + self.model.motor_inertia_kg_m2 * compliance * winding_nm_s2 + viscous_nm
            - gains.shaft_gain_nm_rad * twist_error
            - gains.shaft_damping_nm_s_rad * twist_velocity;
        let stiffness = F::ONE / compliance;
        ControlOutput {
            torque_nm: torque,
            signals: BrakingCurveSignals {
                dead_zone_estimate_rad: dead_zone,
                disturbing_torque_estimate_nm: transmitted_nm - stiffness * lagging_twist,
                load_error_rad: m.load_position_rad - m.reference_position_rad,
                motor_error_rad: twist_error,
                elastic_error_nm: stiffness * twist_error,
                dead_zone_deviation_rad: self
                    .identification
                    .dead_zone_deviation_rad(&self.estimate, self.misfit_rad),
            },
        }
    }
}

impl ControlLaw for BrakingCurve {
    const NAME: &'static str = "braking-curve";
    type Parameters = (BrakingCurveGains, DeadZoneBounds, NominalModel);
    type Signals = BrakingCurveSignals;

    fn new(parameters: Self::Parameters, drive: &DriveParameters) -> Result<Self, ParameterError> {
        let (gains, dead_zone, model) = parameters;
        let setting = BrakingCurveSetting {
            dead_zone,
            load_resolution_rad: drive.load_resolution_rad(),
            torque_limit_nm: drive.torque_limit_nm,
            period_s: drive.period_s(),
        };
        Self::new(&model, gains, setting)
    }

    fn step(&mut self, measurement: &Measurement<f32>) -> ControlOutput<BrakingCurveSignals> {
        Self::step(self, measurement)
    }
}
