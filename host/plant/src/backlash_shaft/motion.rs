//! The right-hand side of the backlash shaft within one mode.

use nalgebra::SVector;

use super::shaft::BacklashShaft;
use super::state::{BRISTLE, ShaftCoordinates, ShaftMode};
use crate::coordinates::{
    DISSIPATED, LOAD_POSITION, LOAD_VELOCITY, MOTOR_POSITION, MOTOR_VELOCITY, SUPPLIED,
};
use crate::integrator::{Rates, Stage};
use crate::mode::{Contact, DryFriction};

/// Right-hand side of masses, energies and, with `LUGRE`, bristles within one mode, with the torques that act on them
/// during one step.
pub(super) struct Masses<'a, const LUGRE: bool> {
    plant: &'a BacklashShaft,
    mode: ShaftMode,
    /// Motor torque at the three stages, in N m.
    motor_torque_nm: [f64; 3],
    load_torque_nm: f64,
    gap_position_rad: f64,
}

impl<'a, const LUGRE: bool> Masses<'a, LUGRE> {
    #[inline(always)]
    pub(super) fn new(
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
            let driving_nm = motor_torque_nm + plant.cogging.torque_nm(x[MOTOR_POSITION]);
            rates[MOTOR_VELOCITY] = (driving_nm - transmitted_nm - friction_nm) * plant.per_motor_inertia;
        }
        rates[SUPPLIED] = motor_torque_nm * motor_velocity + self.load_torque_nm * load_velocity;
        rates[DISSIPATED] = dissipated_w;
        rates
    }
}
