//! The bench as it is built: a shaft with damping in series with the gap, friction that falls with speed, and a drive
//! that lags and saturates.
//!
//! The gap is that of Nordin, Galic and Gutman ("New models for backlash and gear play", 1997): theta_b, the position in
//! it, is a state. In contact theta_b = +-j0 and C = K (z - theta_b) + c dz/dt, as long as that pushes. Off contact C = 0:
//! the shaft relaxes, d(theta_b)/dt = dz/dt + (K / c)(z - theta_b), until theta_b reaches a flank again. So the contact
//! never pulls, and it is found again with the torque it has.
//!
//! Load and motor carry Stribeck friction each, and stick while what drives them stays below stiction. Motor torque
//! follows the command, limited to +-U_max, with the lag T_i. Both the lag and the relaxing shaft are linear and driven by
//! nothing that moves within a step, so they are taken from their closed forms: neither c nor T_i has to be large for the
//! integration to be stable, and either may be nought.

mod dynamics;
mod friction;
mod parameters;
mod stiffness;

use nalgebra::SVector;

pub use parameters::{BristleParameters, ShaftParameters, StribeckParameters};
pub use stiffness::MAX_SUBSTEPS;

use crate::error::within;
use crate::integrator;
use crate::mechanics::{DISSIPATED, LOAD_POSITION, LOAD_VELOCITY, MOTOR_POSITION, MOTOR_VELOCITY, SUPPLIED};
use crate::truth::{Contact, DryFriction, Truth};
use crate::{Mechanics, ParameterError, Plant, PlantError, Start};
use friction::{LoadFriction, Stribeck};

/// The plant of the bench profile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BacklashShaft {
    mechanics: Mechanics,
    parameters: ShaftParameters,
    load_friction: LoadFriction,
    motor_friction: Stribeck,
    /// 1 / J_s and 1 / J_m: a division takes longer than all the rest of a right-hand side.
    per_load_inertia: f64,
    per_motor_inertia: f64,
    substeps: u32,
}

/// What may change around the plant while it runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Environment {
    /// Half the gap in rad; it grows as gears wear.
    pub dead_zone_rad: f64,
    /// Torque on the load from outside, in N m.
    pub load_torque_nm: f64,
}

/// Which right-hand side holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ShaftMode {
    contact: Contact,
    load: DryFriction,
    motor: DryFriction,
}

/// Index of the bristles' deflection, after the coordinates of every plant.
const BRISTLE: usize = 6;

/// Everything that moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShaftCoordinates {
    x: SVector<f64, 7>,
    gap_position_rad: f64,
    motor_torque_nm: f64,
    surroundings: Environment,
}

/// Coordinates and mode.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BacklashShaftState {
    coordinates: ShaftCoordinates,
    mode: ShaftMode,
}

impl BacklashShaft {
    /// A plant integrated in at least `substeps` steps per call; 16 per millisecond leave 1e-9 rad at the load.
    ///
    /// # Errors
    /// Names the first parameter outside its range.
    pub fn new(
        mechanics: Mechanics,
        parameters: ShaftParameters,
        substeps: u32,
    ) -> Result<Self, ParameterError> {
        mechanics.validate()?;
        parameters.validate()?;
        within("substeps", f64::from(substeps), 1.0, f64::from(MAX_SUBSTEPS))?;
        let load_friction = LoadFriction {
            curve: Stribeck::new(parameters.load, parameters.load_asymmetry),
            bristles: parameters.load_bristles,
        };
        let motor_friction = Stribeck::new(parameters.motor, 0.0);
        Ok(Self {
            mechanics,
            parameters,
            load_friction,
            motor_friction,
            per_load_inertia: 1.0 / mechanics.load_inertia_kg_m2,
            per_motor_inertia: 1.0 / mechanics.motor_inertia_kg_m2,
            substeps,
        })
    }

    /// Changes what is around the plant from here on. A gap that widens under a twisted shaft lets it unwind; the energy
    /// that this sets free counts as dissipated.
    ///
    /// # Errors
    /// Names the value outside its range.
    pub fn surround(
        &self,
        state: &mut BacklashShaftState,
        surroundings: Environment,
    ) -> Result<(), ParameterError> {
        within("dead_zone_rad", surroundings.dead_zone_rad, 1e-6, 10.0)?;
        within("load_torque_nm", surroundings.load_torque_nm, -1e6, 1e6)?;
        let BacklashShaftState { coordinates, mode } = state;
        let before_j = self.shaft_energy_j(coordinates);
        let half_gap = surroundings.dead_zone_rad;
        coordinates.gap_position_rad = match mode.contact {
            Contact::Gap => coordinates.gap_position_rad.clamp(-half_gap, half_gap),
            side => side.sign() * half_gap,
        };
        coordinates.surroundings = surroundings;
        coordinates.x[DISSIPATED] += before_j - self.shaft_energy_j(coordinates);
        Ok(())
    }

    /// Takes a state over from the plant that has just changed into this one.
    pub fn take_over(&self, before: &Self, state: &mut BacklashShaftState) {
        let coordinates = &mut state.coordinates;
        coordinates.x[DISSIPATED] += before.shaft_energy_j(coordinates) - self.shaft_energy_j(coordinates);
    }

    /// Twist of the shaft itself, z - theta_b, in rad.
    fn shaft_twist_rad(&self, at: &ShaftCoordinates) -> f64 {
        self.mechanics.twist_of(at.x[LOAD_POSITION], at.x[MOTOR_POSITION]) - at.gap_position_rad
    }

    fn shaft_energy_j(&self, at: &ShaftCoordinates) -> f64 {
        let twist_rad = self.shaft_twist_rad(at);
        0.5 * self.mechanics.stiffness_nm_rad * twist_rad * twist_rad
    }

    /// C in N m.
    fn transmitted_torque_nm(&self, at: &ShaftCoordinates, contact: Contact) -> f64 {
        if contact == Contact::Gap { 0.0 } else { self.shaft_torque_nm(at) }
    }

    /// K (z - theta_b) + c dz/dt in N m.
    fn shaft_torque_nm(&self, at: &ShaftCoordinates) -> f64 {
        let twist_rate = at.x[MOTOR_VELOCITY] - self.mechanics.ratio * at.x[LOAD_VELOCITY];
        self.mechanics.stiffness_nm_rad * self.shaft_twist_rad(at)
            + self.parameters.shaft_damping_nm_s_rad * twist_rate
    }

    /// What drives the load, N0 C and the torque from outside, in N m.
    fn load_drive_nm(&self, at: &ShaftCoordinates, contact: Contact) -> f64 {
        self.mechanics.ratio * self.transmitted_torque_nm(at, contact) + at.surroundings.load_torque_nm
    }

    /// What drives the motor, tau - C, in N m.
    fn motor_drive_nm(&self, at: &ShaftCoordinates, contact: Contact) -> f64 {
        at.motor_torque_nm - self.transmitted_torque_nm(at, contact)
    }
}

impl Plant for BacklashShaft {
    type State = BacklashShaftState;

    fn initial_state(&self, start: Start) -> BacklashShaftState {
        let half_gap = self.mechanics.dead_zone_rad;
        let twist_rad = self.mechanics.twist_of(start.load_position_rad, start.motor_position_rad);
        let coordinates = ShaftCoordinates {
            x: start.coordinates().fixed_resize::<7, 1>(0.0),
            gap_position_rad: twist_rad.clamp(-half_gap, half_gap),
            motor_torque_nm: 0.0,
            surroundings: Environment { dead_zone_rad: half_gap, load_torque_nm: 0.0 },
        };
        let shaft_nm = self.shaft_torque_nm(&coordinates);
        let contact = if twist_rad > half_gap && shaft_nm > 0.0 {
            Contact::Positive
        } else if twist_rad < -half_gap && shaft_nm < 0.0 {
            Contact::Negative
        } else {
            Contact::Gap
        };
        let load = match self.load_friction.bristles {
            Some(_) => DryFriction::SlipPositive,
            None => {
                let drive_nm = self.load_drive_nm(&coordinates, contact);
                self.load_friction.curve.released(start.load_velocity_rad_s, drive_nm)
            }
        };
        let motor_drive_nm = self.motor_drive_nm(&coordinates, contact);
        let motor = self.motor_friction.released(start.motor_velocity_rad_s, motor_drive_nm);
        BacklashShaftState { coordinates, mode: ShaftMode { contact, load, motor } }
    }

    fn step(&self, state: &mut BacklashShaftState, torque_nm: f64, dt_s: f64) -> Result<(), PlantError> {
        let BacklashShaftState { coordinates, mode } = state;
        let substeps = self.substeps(dt_s, coordinates.x[LOAD_VELOCITY])?;
        integrator::advance(self, coordinates, mode, torque_nm, dt_s, substeps)
    }

    fn truth(&self, state: &BacklashShaftState) -> Truth {
        let BacklashShaftState { coordinates: at, mode } = state;
        let [load_velocity, motor_velocity] = [at.x[LOAD_VELOCITY], at.x[MOTOR_VELOCITY]];
        let load_drive_nm = self.load_drive_nm(at, mode.contact);
        let (load_dry_friction_nm, bristle_energy_j) = match self.load_friction.bristles {
            Some(of) => {
                let bend = at.x[BRISTLE];
                let bristles = self.load_friction.bristles(of, load_velocity, bend);
                (bristles.torque_nm, 0.5 * of.stiffness_nm_rad * bend * bend)
            }
            None => (self.load_friction.curve.torque_nm(mode.load, load_velocity, load_drive_nm), 0.0),
        };
        let twist_rad = self.mechanics.twist_of(at.x[LOAD_POSITION], at.x[MOTOR_POSITION]);
        let transmitted_torque_nm = self.transmitted_torque_nm(at, mode.contact);
        Truth {
            load_position_rad: at.x[LOAD_POSITION],
            load_velocity_rad_s: load_velocity,
            motor_position_rad: at.x[MOTOR_POSITION],
            motor_velocity_rad_s: motor_velocity,
            motor_torque_nm: at.motor_torque_nm,
            load_torque_nm: at.surroundings.load_torque_nm,
            twist_rad,
            transmitted_torque_nm,
            disturbing_torque_nm: transmitted_torque_nm - self.mechanics.stiffness_nm_rad * twist_rad,
            gap_position_rad: at.gap_position_rad,
            contact: mode.contact,
            load_friction: mode.load,
            motor_friction: mode.motor,
            load_dry_friction_nm,
            motor_dry_friction_nm: self.motor_friction.torque_nm(
                mode.motor,
                motor_velocity,
                self.motor_drive_nm(at, mode.contact),
            ),
            kinetic_energy_j: self.mechanics.kinetic_energy_j(load_velocity, motor_velocity),
            elastic_energy_j: self.shaft_energy_j(at) + bristle_energy_j,
            supplied_energy_j: at.x[SUPPLIED],
            dissipated_energy_j: at.x[DISSIPATED],
            dead_zone_rad: at.surroundings.dead_zone_rad,
        }
    }
}
