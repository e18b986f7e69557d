//! The motion of the bench plant and the ends of its modes.

use nalgebra::SVector;

use super::{BRISTLE, BacklashShaft, ShaftCoordinates, ShaftMode};
use crate::integrator::{HybridSystem, Rates, Stage, runge_kutta};
use crate::mechanics::{DISSIPATED, LOAD_POSITION, LOAD_VELOCITY, MOTOR_POSITION, MOTOR_VELOCITY, SUPPLIED};
use crate::truth::{Contact, DryFriction};

/// Mode function: the lower flank of the gap, or the contact there.
const LOWER_FLANK: usize = 0;
/// Mode function: the upper flank of the gap, or the contact there.
const UPPER_FLANK: usize = 1;
/// Mode function: dry friction on the load.
const LOAD_FRICTION: usize = 2;
/// Mode function: dry friction on the motor.
const MOTOR_FRICTION: usize = 3;

/// A step length and what decays within it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShaftStride {
    h_s: f64,
    /// Share of the distance between torque and command that is left after half a step, and after a whole one.
    lag: [f64; 2],
    /// Share of the shaft's twist that is left, off contact.
    relaxation: f64,
}

/// The masses, the energies and, with `LUGRE`, the bristles within one mode, and what acts on them during one step from
/// outside the coordinates that are integrated.
struct Masses<'a, const LUGRE: bool> {
    plant: &'a BacklashShaft,
    mode: ShaftMode,
    /// Motor torque at the three stages, in N m.
    motor_torque_nm: [f64; 3],
    load_torque_nm: f64,
    gap_position_rad: f64,
}

/// Share left of what decays with this time constant, which may be nought.
fn left_after(time_s: f64, time_constant_s: f64) -> f64 {
    if time_constant_s > 0.0 { libm::exp(-time_s / time_constant_s) } else { 0.0 }
}

impl<'a, const LUGRE: bool> Masses<'a, LUGRE> {
    #[inline(always)]
    fn new(
        plant: &'a BacklashShaft,
        at: &ShaftCoordinates,
        mode: ShaftMode,
        motor_torque_nm: [f64; 3],
    ) -> Self {
        let load_torque_nm = at.surroundings.load_torque_nm;
        Self { plant, mode, motor_torque_nm, load_torque_nm, gap_position_rad: at.gap_position_rad }
    }
}

impl<const LUGRE: bool> Rates<7> for Masses<'_, LUGRE> {
    #[inline(always)]
    fn at(&self, x: &SVector<f64, 7>, stage: Stage) -> SVector<f64, 7> {
        let Self { plant, mode, .. } = self;
        let m = &plant.mechanics;
        let [load_velocity, motor_velocity] = [x[LOAD_VELOCITY], x[MOTOR_VELOCITY]];
        let motor_torque_nm = self.motor_torque_nm[stage as usize];
        let mut rates = SVector::<f64, 7>::zeros();
        let (mut transmitted_nm, mut dissipated_w) = (0.0, 0.0);
        if mode.contact != Contact::Gap {
            let shaft_twist = m.twist_of(x[LOAD_POSITION], x[MOTOR_POSITION]) - self.gap_position_rad;
            let twist_rate = motor_velocity - m.ratio * load_velocity;
            let damping_nm = plant.parameters.shaft_damping_nm_s_rad * twist_rate;
            transmitted_nm = m.stiffness_nm_rad * shaft_twist + damping_nm;
            dissipated_w = damping_nm * twist_rate;
        }
        if LUGRE || mode.load != DryFriction::Stick {
            let mut friction_nm = m.load_friction_nm_s_rad * load_velocity;
            dissipated_w += friction_nm * load_velocity;
            match plant.load_friction.bristles {
                Some(of) if LUGRE => {
                    let bristles = plant.load_friction.bristles(of, load_velocity, x[BRISTLE]);
                    friction_nm += bristles.torque_nm;
                    dissipated_w += bristles.dissipated_w;
                    rates[BRISTLE] = bristles.bending_rad_s;
                }
                _ => {
                    let sign = mode.load.sign();
                    let dry_nm = sign * plant.load_friction.curve.magnitude_nm(load_velocity, sign);
                    friction_nm += dry_nm;
                    dissipated_w += dry_nm * load_velocity;
                }
            }
            let driven_nm = m.ratio * transmitted_nm + self.load_torque_nm;
            rates[LOAD_POSITION] = load_velocity;
            rates[LOAD_VELOCITY] = (driven_nm - friction_nm) * plant.per_load_inertia;
        }
        if mode.motor != DryFriction::Stick {
            let sign = mode.motor.sign();
            let friction_nm = m.motor_friction_nm_s_rad * motor_velocity
                + sign * plant.motor_friction.magnitude_nm(motor_velocity, sign);
            dissipated_w += friction_nm * motor_velocity;
            rates[MOTOR_POSITION] = motor_velocity;
            rates[MOTOR_VELOCITY] =
                (motor_torque_nm - transmitted_nm - friction_nm) * plant.per_motor_inertia;
        }
        rates[SUPPLIED] = motor_torque_nm * motor_velocity + self.load_torque_nm * load_velocity;
        rates[DISSIPATED] = dissipated_w;
        rates
    }
}

impl BacklashShaft {
    fn command_nm(&self, torque_nm: f64) -> f64 {
        torque_nm.clamp(-self.parameters.torque_saturation_nm, self.parameters.torque_saturation_nm)
    }

    /// The mode of masses at rest under what drives them now.
    fn at_rest(&self, at: &ShaftCoordinates, mode: ShaftMode) -> ShaftMode {
        let mut settled = mode;
        if at.x[LOAD_VELOCITY] == 0.0 && self.load_friction.bristles.is_none() {
            settled.load = self.load_friction.curve.at_rest(self.load_drive_nm(at, mode.contact));
        }
        if at.x[MOTOR_VELOCITY] == 0.0 {
            settled.motor = self.motor_friction.at_rest(self.motor_drive_nm(at, mode.contact));
        }
        settled
    }
}

impl HybridSystem for BacklashShaft {
    type State = ShaftCoordinates;
    type Mode = ShaftMode;
    type Stride = ShaftStride;
    const GUARDS: usize = 4;

    fn stride(&self, h_s: f64) -> ShaftStride {
        let half_lag = left_after(0.5 * h_s, self.parameters.current_lag_s);
        let shaft_s = self.parameters.shaft_damping_nm_s_rad / self.mechanics.stiffness_nm_rad;
        ShaftStride { h_s, lag: [half_lag, half_lag * half_lag], relaxation: left_after(h_s, shaft_s) }
    }

    #[inline]
    fn flow(
        &self,
        at: &ShaftCoordinates,
        mode: ShaftMode,
        torque_nm: f64,
        stride: ShaftStride,
    ) -> ShaftCoordinates {
        let command_nm = self.command_nm(torque_nm);
        let behind_nm = at.motor_torque_nm - command_nm;
        let [middle, end] = stride.lag.map(|left| command_nm + behind_nm * left);
        let motor_torque_nm = [at.motor_torque_nm, middle, end];
        let x = if self.load_friction.bristles.is_some() {
            runge_kutta(&at.x, stride.h_s, &Masses::<true>::new(self, at, mode, motor_torque_nm))
        } else {
            runge_kutta(&at.x, stride.h_s, &Masses::<false>::new(self, at, mode, motor_torque_nm))
        };
        let mut next = ShaftCoordinates { x, motor_torque_nm: end, ..*at };
        if mode.contact == Contact::Gap {
            let before_rad = self.shaft_twist_rad(at);
            let after_rad = before_rad * stride.relaxation;
            next.gap_position_rad = self.mechanics.twist_of(x[LOAD_POSITION], x[MOTOR_POSITION]) - after_rad;
            // What the spring loses off contact, the damping takes.
            next.x[DISSIPATED] +=
                0.5 * self.mechanics.stiffness_nm_rad * (before_rad - after_rad) * (before_rad + after_rad);
        }
        next
    }

    #[inline]
    fn guard(&self, guard: usize, at: &ShaftCoordinates, mode: ShaftMode, _torque_nm: f64) -> f64 {
        let half_gap = at.surroundings.dead_zone_rad;
        match (guard, mode.contact) {
            (LOWER_FLANK, Contact::Gap) => at.gap_position_rad + half_gap,
            (UPPER_FLANK, Contact::Gap) => half_gap - at.gap_position_rad,
            (LOWER_FLANK, Contact::Negative) => -self.shaft_torque_nm(at),
            (UPPER_FLANK, Contact::Positive) => self.shaft_torque_nm(at),
            // The flank on the far side of the gap is reached only by way of the gap.
            (LOWER_FLANK | UPPER_FLANK, _) => half_gap,
            (LOAD_FRICTION, _) if self.load_friction.bristles.is_some() => half_gap,
            (LOAD_FRICTION, contact) => {
                let drive_nm = self.load_drive_nm(at, contact);
                self.load_friction.curve.guard(mode.load, at.x[LOAD_VELOCITY], drive_nm)
            }
            (_, contact) => {
                let drive_nm = self.motor_drive_nm(at, contact);
                self.motor_friction.guard(mode.motor, at.x[MOTOR_VELOCITY], drive_nm)
            }
        }
    }

    fn switch(&self, guard: usize, at: &mut ShaftCoordinates, mode: ShaftMode, _torque_nm: f64) -> ShaftMode {
        match guard {
            LOAD_FRICTION => {
                at.x[LOAD_VELOCITY] = 0.0;
                let drive_nm = self.load_drive_nm(at, mode.contact);
                ShaftMode { load: self.load_friction.curve.after(mode.load, drive_nm), ..mode }
            }
            MOTOR_FRICTION => {
                at.x[MOTOR_VELOCITY] = 0.0;
                let drive_nm = self.motor_drive_nm(at, mode.contact);
                ShaftMode { motor: self.motor_friction.after(mode.motor, drive_nm), ..mode }
            }
            flank => {
                let side = if flank == UPPER_FLANK { Contact::Positive } else { Contact::Negative };
                at.gap_position_rad = side.sign() * at.surroundings.dead_zone_rad;
                let contact = if mode.contact == Contact::Gap { side } else { Contact::Gap };
                ShaftMode { contact, ..mode }
            }
        }
    }

    fn settle(&self, at: &mut ShaftCoordinates, mode: ShaftMode, torque_nm: f64) -> ShaftMode {
        if self.parameters.current_lag_s == 0.0 {
            at.motor_torque_nm = self.command_nm(torque_nm);
        }
        self.at_rest(at, mode)
    }

    fn is_finite(&self, at: &ShaftCoordinates) -> bool {
        let rest = [at.gap_position_rad, at.motor_torque_nm];
        at.x.iter().chain(&rest).all(|coordinate| coordinate.is_finite())
    }
}
