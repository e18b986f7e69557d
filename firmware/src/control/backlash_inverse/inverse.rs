//! The law: transmitted torque to motor torque, across the gap.

use super::gains::BacklashInverseGains;
use super::load_loop::{LoadLoop, LoadLoopState};
use crate::control::cascade_signals::CascadeSignals;
use crate::control::dead_zone_observer::DeadZoneBounds;
use crate::control::gap_identification::{Estimate, Gap, Identification, Machine, ShaftSample};
use crate::control::lag::alpha;
use crate::control::load_observer::{LoadObserver, LoadObserverState};
use crate::control::momentum_observer::{MomentumObserver, MomentumObserverPole};
use crate::control::motor_friction::MotorFriction;
use crate::control::nominal_model::NominalModel;
use crate::law::{ControlLaw, ControlOutput, DriveParameters, Measurement, ParameterError, Real};

/// What the law needs besides mechanics and gains.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BacklashInverseSetting<F> {
    /// Pole of the momentum observer in rad/s.
    pub momentum_observer_rad_s: F,
    /// Start and upper bound of the dead-zone estimate.
    pub dead_zone: DeadZoneBounds<F>,
    /// One count of the motor encoder in rad.
    pub motor_resolution_rad: F,
    /// One count of the load encoder in rad.
    pub load_resolution_rad: F,
    /// Torque limit of the drive in N m, which bounds the transmitted torque too.
    pub torque_limit_nm: F,
    /// Control period in seconds.
    pub period_s: F,
}

/// The law with its constants and its state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BacklashInverse<F: Real = f32> {
    model: NominalModel<F>,
    gains: BacklashInverseGains<F>,
    load_loop: LoadLoop<F>,
    momentum: MomentumObserver<F>,
    load_observer: LoadObserver<F>,
    identification: Identification<F>,
    per_crossing_nm: F,
    twist_pole_rad_s: F,
    twist_alpha: F,
    estimate: Estimate<F>,
    load_loop_state: LoadLoopState<F>,
    momentum_balance_nm: F,
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

impl<F: Real> Observers<F> {
    fn at(measurement: &Measurement<F>) -> Self {
        Self {
            load: LoadObserver::initial_state(measurement.load_position_rad),
            motor_friction: MotorFriction::at(measurement.motor_position_rad),
            twist_rad: measurement.twist_rad,
        }
    }
}

impl<F: Real> BacklashInverse<F> {
    /// The law in its initial state, for the mechanics of `model`.
    ///
    /// # Errors
    /// If gains don't go with the period, the motor's inertia or each other.
    pub fn new(
        model: &NominalModel<F>,
        gains: BacklashInverseGains<F>,
        setting: BacklashInverseSetting<F>,
    ) -> Result<Self, ParameterError> {
        let BacklashInverseSetting { momentum_observer_rad_s, period_s, .. } = setting;
        gains.validate(model.motor_inertia_kg_m2, period_s)?;
        setting.dead_zone.validate()?;
        let gains = BacklashInverseGains {
            transmitted_limit_nm: gains
                .transmitted_limit_nm
                .clamp(-setting.torque_limit_nm, setting.torque_limit_nm),
            ..gains
        };
        // This law takes its torque as exact, and reports no deviation.
        let identification = Identification::new(&Machine {
            stiffness_nm_rad: model.stiffness_nm_rad,
            motor_inertia_kg_m2: model.motor_inertia_kg_m2,
            motor_coulomb_nm: model.motor_coulomb_nm,
            torque_limit_nm: setting.torque_limit_nm,
            offset_deviation: F::ZERO,
            ripple_deviation: F::ZERO,
            speed_deviation: F::ZERO,
            speed_limit_rad_s: F::ZERO,
            motor_count_rad: setting.motor_resolution_rad,
            load_count_rad: model.reduction_ratio * setting.load_resolution_rad,
            initial_rad: setting.dead_zone.dead_zone_initial_rad,
            max_rad: setting.dead_zone.dead_zone_max_rad,
            period_s,
        });
        Ok(Self {
            model: *model,
            gains,
            load_loop: LoadLoop::new(model, gains, setting.load_resolution_rad, period_s),
            momentum: MomentumObserver::new(model, momentum_observer_rad_s, period_s),
            load_observer: LoadObserver::new(model, gains.load_observer_rad_s, period_s),
            identification,
            per_crossing_nm: F::ONE / gains.gap_crossing_nm,
            twist_pole_rad_s: momentum_observer_rad_s,
            twist_alpha: alpha(momentum_observer_rad_s, period_s),
            estimate: identification.initial_estimate(),
            load_loop_state: LoadLoop::initial_state(),
            momentum_balance_nm: F::ZERO,
            observers: None,
        })
    }

    /// The torque for one sample, before the drive's limit.
    pub fn step(&mut self, measurement: &Measurement<F>) -> ControlOutput<CascadeSignals<F>, F> {
        let m = measurement;
        let observers = self.observers.get_or_insert_with(|| Observers::at(m));

        let friction = observers.motor_friction.step(m.motor_position_rad);
        let coulomb_nm = self.model.motor_coulomb_nm * friction;
        let transmitted_nm = self.momentum.step_against(&mut self.momentum_balance_nm, m, coulomb_nm);
        let load_velocity = self.load_observer.step(&mut observers.load, m.load_position_rad, transmitted_nm);

        let behind_rad = m.twist_rad - observers.twist_rad;
        let lagging_twist = observers.twist_rad + self.twist_alpha * behind_rad;
        observers.twist_rad = lagging_twist;
        let viscous_nm = self.model.motor_friction_nm_s_rad * m.motor_velocity_rad_s;
        let sample = ShaftSample {
            transmitted_nm,
            accelerating_nm: m.applied_torque_nm - viscous_nm - coulomb_nm - transmitted_nm,
            twist_rad: lagging_twist,
            twist_rate_rad_s: self.twist_pole_rad_s * (m.twist_rad - lagging_twist),
            motor_velocity_rad_s: m.motor_velocity_rad_s,
            friction,
        };
        let holds = self.load_loop_state.holding || transmitted_nm.abs() < self.gains.identification_min_nm;
        self.identification.step(&mut self.estimate, &sample, holds);

        let wanted_nm = self.load_loop.step(&mut self.load_loop_state, m, load_velocity);
        let Gap { compliance_rad_nm: compliance, dead_zone_rad: dead_zone } =
            self.identification.gap(&self.estimate);
        let side = (self.per_crossing_nm * wanted_nm).clamp(-F::ONE, F::ONE);
        let twist_error = m.twist_rad - (compliance * wanted_nm + dead_zone * side);
        let twist_velocity = m.motor_velocity_rad_s - self.model.reduction_ratio * load_velocity;
        let torque = wanted_nm + viscous_nm
            - self.gains.twist_gain_nm_rad * twist_error
            - self.gains.twist_damping_nm_s_rad * twist_velocity;
        let stiffness = F::ONE / compliance;
        ControlOutput {
            torque_nm: torque,
            signals: CascadeSignals {
                dead_zone_estimate_rad: dead_zone,
                disturbing_torque_estimate_nm: transmitted_nm - stiffness * lagging_twist,
                load_error_rad: m.load_position_rad - m.reference_position_rad,
                // The load loop requests a twist, that is, a motor position relative to the load.
                motor_error_rad: twist_error,
                elastic_error_nm: stiffness * twist_error,
            },
        }
    }
}

impl ControlLaw for BacklashInverse {
    const NAME: &'static str = "backlash-inverse";
    type Parameters = (BacklashInverseGains, DeadZoneBounds, MomentumObserverPole, NominalModel);
    type Signals = CascadeSignals;

    fn new(parameters: Self::Parameters, drive: &DriveParameters) -> Result<Self, ParameterError> {
        let (gains, dead_zone, pole, model) = parameters;
        let setting = BacklashInverseSetting {
            momentum_observer_rad_s: pole.momentum_observer_rad_s,
            dead_zone,
            motor_resolution_rad: drive.motor_resolution_rad(),
            load_resolution_rad: drive.load_resolution_rad(),
            torque_limit_nm: drive.torque_limit_nm,
            period_s: drive.period_s(),
        };
        Self::new(&model, gains, setting)
    }

    fn step(&mut self, measurement: &Measurement<f32>) -> ControlOutput<CascadeSignals> {
        Self::step(self, measurement)
    }
}
