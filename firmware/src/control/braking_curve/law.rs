//! The law: load loop, winding, inverse of the gap, and identification of the gap.

use super::gains::{BrakingCurveSetting, Gains};
use super::load_loop::{LoadLoop, LoadLoopState};
use super::signals::BrakingCurveSignals;
use super::tuning::BrakingCurveTuning;
use super::winding::{Winding, WindingState};
use crate::control::dead_zone_observer::DeadZoneBounds;
use crate::control::gap_identification::{Estimate, Identification, Machine, ShaftSample};
use crate::control::lag::alpha;
use crate::control::load_observer::{LoadObserver, LoadObserverState};
use crate::control::momentum_observer::MomentumObserver;
use crate::control::motor_friction::MotorFriction;
use crate::control::nominal_model::NominalModel;
use crate::control::torque_knowledge::TorqueKnowledge;
use crate::law::{ControlLaw, ControlOutput, DriveParameters, Measurement, ParameterError, Real};

/// Torque that a measurement may differ from the command without being missing, relative to the limit.
const MISSING: f64 = 0.02;

/// The law with its constants and its state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BrakingCurve<F: Real = f32> {
    model: NominalModel<F>,
    torque: TorqueKnowledge<F>,
    gains: Gains<F>,
    load_loop: LoadLoop<F>,
    winding: Winding<F>,
    momentum: MomentumObserver<F>,
    load_observer: LoadObserver<F>,
    identification: Identification<F>,
    limit_nm: F,
    tolerated_nm: F,
    per_crossing_nm: F,
    per_friction_turn_s_rad: F,
    twist_alpha: F,
    motor_alpha: F,
    estimate: Estimate<F>,
    load_loop_state: LoadLoopState<F>,
    winding_state: WindingState<F>,
    momentum_balance_nm: F,
    /// The torque of the last sample.
    commanded_nm: F,
    /// `None` before the first sample.
    observers: Option<Observers<F>>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Observers<F> {
    load: LoadObserverState<F>,
    motor_friction: MotorFriction<F>,
    /// The twist behind the lag of the momentum observer, so that both belong to the same instant.
    twist_rad: F,
    /// Velocity of the motor for its loop, behind a lag.
    motor_velocity_rad_s: F,
}

impl<F: Real> BrakingCurve<F> {
    /// The law in its initial state, for the mechanics of `model`.
    ///
    /// # Errors
    /// If the initial half gap is beyond its bound.
    pub fn new(
        model: &NominalModel<F>,
        tuning: &BrakingCurveTuning<F>,
        torque: &TorqueKnowledge<F>,
        dead_zone: &DeadZoneBounds<F>,
        setting: &BrakingCurveSetting<F>,
    ) -> Result<Self, ParameterError> {
        dead_zone.validate()?;
        let (period_s, limit_nm) = (setting.period_s, setting.torque_limit_nm);
        let gains = Gains::new(model, tuning, setting);
        let identification = Identification::new(&Machine {
            stiffness_nm_rad: model.stiffness_nm_rad,
            motor_inertia_kg_m2: model.motor_inertia_kg_m2,
            motor_coulomb_nm: model.motor_coulomb_nm,
            torque_limit_nm: limit_nm,
            offset_deviation: torque.torque_offset_deviation,
            ripple_deviation: torque.torque_ripple_deviation,
            speed_deviation: torque.torque_speed_deviation,
            speed_limit_rad_s: setting.motor_speed_limit_rad_s,
            motor_count_rad: setting.motor_resolution_rad,
            load_count_rad: model.reduction_ratio * setting.load_resolution_rad,
            initial_rad: dead_zone.dead_zone_initial_rad,
            max_rad: dead_zone.dead_zone_max_rad,
            period_s,
        });
        Ok(Self {
            model: *model,
            torque: *torque,
            gains,
            load_loop: LoadLoop::new(model, &gains, tuning.load_coulomb_nm, period_s),
            winding: Winding {
                pole_rad_s: gains.winding_rad_s,
                speed_limit_rad_s: gains.winding_speed_rad_s,
                motor_inertia_kg_m2: model.motor_inertia_kg_m2,
                period_s,
            },
            momentum: MomentumObserver::new(model, gains.shaft_observer_rad_s, period_s),
            load_observer: LoadObserver::new(model, gains.speed_observer_rad_s, period_s),
            identification,
            limit_nm,
            tolerated_nm: F::from_f64(MISSING) * limit_nm,
            per_crossing_nm: F::ONE / gains.crossing_nm,
            per_friction_turn_s_rad: F::ONE / gains.friction_turn_rad_s,
            twist_alpha: alpha(gains.shaft_observer_rad_s, period_s),
            motor_alpha: alpha(gains.motor_filter_rad_s, period_s),
            estimate: identification.initial_estimate(),
            load_loop_state: LoadLoop::initial_state(),
            winding_state: Winding::initial_state(),
            momentum_balance_nm: F::ZERO,
            commanded_nm: F::ZERO,
            observers: None,
        })
    }

    /// The torque for one sample, before the drive's limit.
    pub fn step(&mut self, measurement: &Measurement<F>) -> ControlOutput<BrakingCurveSignals<F>, F> {
        let added_nm = self.torque.added_nm(measurement.motor_position_rad);
        let missing_nm = self.commanded_nm - measurement.applied_torque_nm;
        let missing_nm = if missing_nm.abs() > self.tolerated_nm { missing_nm } else { F::ZERO };
        let m = &Measurement { applied_torque_nm: measurement.applied_torque_nm + added_nm, ..*measurement };
        let observers = self.observers.get_or_insert_with(|| Observers {
            load: LoadObserver::initial_state(m.load_position_rad),
            motor_friction: MotorFriction::at(m.motor_position_rad),
            twist_rad: m.twist_rad,
            motor_velocity_rad_s: m.motor_velocity_rad_s,
        });
        let (gains, model) = (&self.gains, &self.model);

        let friction = observers.motor_friction.step(m.motor_position_rad);
        let coulomb_nm = model.motor_coulomb_nm * friction;
        let transmitted_nm = self.momentum.step_against(&mut self.momentum_balance_nm, m, coulomb_nm);
        let load_velocity = self.load_observer.step(&mut observers.load, m.load_position_rad, transmitted_nm);
        observers.motor_velocity_rad_s +=
            self.motor_alpha * (m.motor_velocity_rad_s - observers.motor_velocity_rad_s);
        let motor_velocity = observers.motor_velocity_rad_s;

        let behind_rad = m.twist_rad - observers.twist_rad;
        observers.twist_rad += self.twist_alpha * behind_rad;
        let lagging_twist = observers.twist_rad;
        let viscous_nm = model.motor_friction_nm_s_rad * m.motor_velocity_rad_s;
        let accelerating_nm = m.applied_torque_nm - viscous_nm - coulomb_nm - transmitted_nm;
        let twist_rate = gains.shaft_observer_rad_s * (m.twist_rad - lagging_twist);
        let sample = ShaftSample {
            transmitted_nm,
            accelerating_nm,
            twist_rad: lagging_twist,
            twist_rate_rad_s: twist_rate,
            motor_velocity_rad_s: motor_velocity,
            friction,
        };
        self.identification.step(&mut self.estimate, &sample, self.load_loop_state.holding);

        let load = observers.load.observed(transmitted_nm);
        let command = self.load_loop.step(&mut self.load_loop_state, m, &load, missing_nm);
        let gap = self.identification.gap(&self.estimate);
        let compliance = gap.compliance_rad_nm;
        let WindingState { torque_nm: wound_nm, rate_nm_s } = self.winding_state;
        let side = (self.per_crossing_nm * wound_nm).clamp(-F::ONE, F::ONE);
        // With the observed position of the load, whose counts the reduction ratio multiplies.
        let twist = m.twist_rad + model.reduction_ratio * load.position_error_rad;
        let twist_error = twist - (compliance * wound_nm + gap.dead_zone_rad * side);
        let wanted_velocity = model.reduction_ratio * load_velocity + compliance * rate_nm_s;
        let direction = (self.per_friction_turn_s_rad * wanted_velocity).clamp(-F::ONE, F::ONE);
        let steady_nm = wound_nm - added_nm
            + model.motor_inertia_kg_m2 * model.reduction_ratio * command.acceleration_rad_s2
            + model.motor_friction_nm_s_rad * motor_velocity
            + model.motor_coulomb_nm * direction
            - gains.shaft_nm_rad * twist_error
            - gains.shaft_nm_s_rad * (motor_velocity - wanted_velocity);
        let room_nm = (room(self.limit_nm + steady_nm), room(self.limit_nm - steady_nm));
        let winding_nm_s2 =
            self.winding.acceleration_nm_s2(&self.winding_state, command.torque_nm, compliance, room_nm);
        self.winding.advance(&mut self.winding_state, winding_nm_s2);
        let torque = steady_nm + model.motor_inertia_kg_m2 * compliance * winding_nm_s2;
        self.commanded_nm = torque;
        let stiffness = F::ONE / compliance;
        ControlOutput {
            torque_nm: torque,
            signals: BrakingCurveSignals {
                dead_zone_estimate_rad: gap.dead_zone_rad,
                disturbing_torque_estimate_nm: transmitted_nm - stiffness * lagging_twist,
                load_error_rad: m.load_position_rad - m.reference_position_rad,
                motor_error_rad: twist_error,
                elastic_error_nm: stiffness * twist_error,
                dead_zone_deviation_rad: self.identification.dead_zone_deviation_rad(&self.estimate),
            },
        }
    }
}

/// What is left of a torque, not below zero.
fn room<F: Real>(torque_nm: F) -> F {
    if torque_nm > F::ZERO { torque_nm } else { F::ZERO }
}

impl ControlLaw for BrakingCurve {
    const NAME: &'static str = "braking-curve";
    type Parameters = (BrakingCurveTuning, TorqueKnowledge, DeadZoneBounds, NominalModel);
    type Signals = BrakingCurveSignals;

    fn new(parameters: Self::Parameters, drive: &DriveParameters) -> Result<Self, ParameterError> {
        let (tuning, torque, dead_zone, model) = parameters;
        let setting = BrakingCurveSetting {
            motor_resolution_rad: drive.motor_resolution_rad(),
            load_resolution_rad: drive.load_resolution_rad(),
            torque_limit_nm: drive.torque_limit_nm,
            motor_speed_limit_rad_s: drive.motor_speed_limit_rad_s,
            period_s: drive.period_s(),
        };
        Self::new(&model, &tuning, &torque, &dead_zone, &setting)
    }

    fn step(&mut self, measurement: &Measurement<f32>) -> ControlOutput<BrakingCurveSignals> {
        Self::step(self, measurement)
    }
}
