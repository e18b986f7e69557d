//! Modes of the backlash shaft: one step within a mode, its guards, and the mode that follows.

use nalgebra::SVector;

use super::load_mode::{LoadMode, MassState};
use super::motion::Masses;
use super::parameters::ShaftParameters;
use super::shaft::BacklashShaft;
use super::state::{ShaftCoordinates, ShaftMode};
use crate::coordinates::{LOAD_VELOCITY, MOTOR_VELOCITY};
use crate::integrator::{HybridSystem, runge_kutta};
use crate::limits::are_in_range;
use crate::mode::{Contact, DryFriction, Flank};

/// What may end a mode.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ShaftGuard {
    /// Contact at a flank begins or ends.
    Flank(Flank),
    /// The load sticks or breaks away.
    LoadFriction,
    /// The motor sticks or breaks away.
    MotorFriction,
}

/// A step length and the decay factors that depend on it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShaftStride {
    h_s: f64,
    /// Fraction of the distance from torque to command that remains after half a step, and after a whole one.
    lag: [f64; 2],
    /// Fraction of the shaft's twist that remains after a step off contact.
    relaxation: f64,
}

/// Fraction that remains after an exponential decay; the time constant may be zero.
fn remaining(time_s: f64, time_constant_s: f64) -> f64 {
    if time_constant_s > 0.0 { libm::exp(-time_s / time_constant_s) } else { 0.0 }
}

impl BacklashShaft {
    pub(super) fn command_nm(&self, torque_nm: f64) -> f64 {
        let ShaftParameters { torque_offset_nm, torque_saturation_nm, .. } = self.parameters;
        (torque_nm + torque_offset_nm).clamp(-torque_saturation_nm, torque_saturation_nm)
    }

    /// Coordinates, energies and outer mass after one step of Runge-Kutta.
    #[inline(always)]
    fn stepped<const LUGRE: bool>(
        &self,
        at: &ShaftCoordinates,
        mode: ShaftMode,
        masses: &Masses<'_, LUGRE>,
        h_s: f64,
    ) -> (SVector<f64, 7>, MassState) {
        let Some(load_mode) = &self.load_mode else { return (runge_kutta(&at.x, h_s, masses), at.outer) };
        let moves = LUGRE || mode.load != DryFriction::Stick;
        let rates = load_mode.rates(masses, if moves { self.per_load_inertia } else { 0.0 });
        LoadMode::parted(&runge_kutta(&LoadMode::joined(&at.x, at.outer), h_s, &rates))
    }

    /// The mode after the friction state of masses at rest follows their driving torques.
    fn at_rest(&self, at: &ShaftCoordinates, mode: ShaftMode) -> ShaftMode {
        let mut settled = mode;
        if at.x[LOAD_VELOCITY] == 0.0 && self.load_friction.bristles.is_none() {
            let limits_nm = self.load_friction.curve.limits_nm;
            settled.load = DryFriction::at_rest(self.load_drive_nm(at, mode.contact), limits_nm);
        }
        if at.x[MOTOR_VELOCITY] == 0.0 {
            let limits_nm = self.motor_friction.limits_nm;
            settled.motor = DryFriction::at_rest(self.motor_drive_nm(at, mode.contact), limits_nm);
        }
        settled
    }
}

impl HybridSystem for BacklashShaft {
    type State = ShaftCoordinates;
    type Mode = ShaftMode;
    type Stride = ShaftStride;
    type Guard = ShaftGuard;
    const GUARDS: &'static [ShaftGuard] = &[
        ShaftGuard::Flank(Flank::Lower),
        ShaftGuard::Flank(Flank::Upper),
        ShaftGuard::LoadFriction,
        ShaftGuard::MotorFriction,
    ];

    fn stride(&self, h_s: f64) -> ShaftStride {
        let half_lag = remaining(0.5 * h_s, self.parameters.current_lag_s);
        let shaft_s = self.parameters.shaft_damping_nm_s_rad / self.mechanics.stiffness_nm_rad;
        ShaftStride { h_s, lag: [half_lag, half_lag * half_lag], relaxation: remaining(h_s, shaft_s) }
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
        let [middle, end] = stride.lag.map(|fraction| command_nm + behind_nm * fraction);
        let motor_torque_nm = [at.motor_torque_nm, middle, end];
        let (x, outer) = if self.load_friction.bristles.is_some() {
            self.stepped(at, mode, &Masses::<true>::new(self, at, mode, motor_torque_nm), stride.h_s)
        } else {
            self.stepped(at, mode, &Masses::<false>::new(self, at, mode, motor_torque_nm), stride.h_s)
        };
        let mut next = ShaftCoordinates { x, outer, motor_torque_nm: end, ..*at };
        if mode.contact == Contact::Gap {
            self.relax(at, &mut next, stride.relaxation);
        }
        next
    }

    #[inline]
    fn guard(&self, guard: ShaftGuard, at: &ShaftCoordinates, mode: ShaftMode) -> f64 {
        match guard {
            ShaftGuard::Flank(flank) => self.flank_guard(flank, at, mode.contact),
            // Bristles bend instead of sticking: this guard never reaches zero.
            ShaftGuard::LoadFriction if self.load_friction.bristles.is_some() => 1.0,
            ShaftGuard::LoadFriction => {
                let drive_nm = self.load_drive_nm(at, mode.contact);
                mode.load.guard(at.x[LOAD_VELOCITY], drive_nm, self.load_friction.curve.limits_nm)
            }
            ShaftGuard::MotorFriction => {
                let drive_nm = self.motor_drive_nm(at, mode.contact);
                mode.motor.guard(at.x[MOTOR_VELOCITY], drive_nm, self.motor_friction.limits_nm)
            }
        }
    }

    fn switch(&self, guard: ShaftGuard, at: &mut ShaftCoordinates, mode: ShaftMode) -> ShaftMode {
        match guard {
            ShaftGuard::LoadFriction => {
                at.x[LOAD_VELOCITY] = 0.0;
                let drive_nm = self.load_drive_nm(at, mode.contact);
                ShaftMode { load: self.load_friction.curve.after(mode.load, drive_nm), ..mode }
            }
            ShaftGuard::MotorFriction => {
                at.x[MOTOR_VELOCITY] = 0.0;
                let drive_nm = self.motor_drive_nm(at, mode.contact);
                ShaftMode { motor: self.motor_friction.after(mode.motor, drive_nm), ..mode }
            }
            ShaftGuard::Flank(flank) => {
                ShaftMode { contact: self.after_flank(flank, at, mode.contact), ..mode }
            }
        }
    }

    fn settle(&self, at: &mut ShaftCoordinates, mode: ShaftMode, torque_nm: f64) -> ShaftMode {
        if self.parameters.current_lag_s == 0.0 {
            at.motor_torque_nm = self.command_nm(torque_nm);
        }
        self.at_rest(at, mode)
    }

    fn is_in_range(&self, at: &ShaftCoordinates) -> bool {
        let rest = [at.gap_position_rad, at.motor_torque_nm, at.outer.position_rad, at.outer.velocity_rad_s];
        are_in_range(at.x.iter().chain(&rest))
    }
}
