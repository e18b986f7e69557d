//! The plant: release, step, truth, and changes while it runs.

use super::load_mode::MassState;
use super::shaft::BacklashShaft;
use super::state::{BRISTLE, BacklashShaftState, ShaftCoordinates, ShaftMode, Surroundings};
use crate::coordinates::{self, DISSIPATED, LOAD_POSITION, LOAD_VELOCITY, MOTOR_POSITION, MOTOR_VELOCITY};
use crate::integrator;
use crate::mode::{Contact, DryFriction};
use crate::{Environment, PlantError, Positions, Release, RunningPlant, Start, Truth, TwoMass};

impl BacklashShaft {
    /// Released at `start` under a command of `torque_nm` that has lasted longer than the lag of the current loop.
    #[must_use]
    pub fn released_under(self, start: Start, torque_nm: f64) -> RunningPlant<Self> {
        let state = self.state_under(start, self.command_nm(torque_nm));
        RunningPlant { plant: self, state }
    }

    fn state_under(&self, start: Start, motor_torque_nm: f64) -> BacklashShaftState {
        let half_gap = self.mechanics.dead_zone_rad;
        let twist_rad = self.mechanics.twist_of(start.load_position_rad, start.motor_position_rad);
        let coordinates = ShaftCoordinates {
            x: start.coordinates().fixed_resize::<7, 1>(0.0),
            outer: MassState {
                position_rad: start.load_position_rad,
                velocity_rad_s: start.load_velocity_rad_s,
            },
            gap_position_rad: twist_rad.clamp(-half_gap, half_gap),
            motor_torque_nm,
            surroundings: Surroundings { dead_zone_rad: half_gap, load_torque_nm: 0.0 },
        };
        let contact = self.contact_at_release(&coordinates);
        let load = match self.load_friction.bristles {
            Some(_) => DryFriction::SlipPositive,
            None => {
                let drive_nm = self.load_drive_nm(&coordinates, contact);
                let limits_nm = self.load_friction.curve.limits_nm;
                DryFriction::released(start.load_velocity_rad_s, drive_nm, limits_nm)
            }
        };
        let motor_drive_nm = self.motor_drive_nm(&coordinates, contact);
        let limits_nm = self.motor_friction.limits_nm;
        let motor = DryFriction::released(start.motor_velocity_rad_s, motor_drive_nm, limits_nm);
        BacklashShaftState { coordinates, mode: ShaftMode { contact, load, motor } }
    }
}

impl TwoMass for BacklashShaft {
    type State = BacklashShaftState;

    fn initial_state(&self, start: Start) -> BacklashShaftState {
        self.state_under(start, 0.0)
    }

    fn step(&self, state: &mut BacklashShaftState, torque_nm: f64, dt_s: f64) -> Result<(), PlantError> {
        let BacklashShaftState { coordinates, mode } = state;
        let substeps = self.substeps(dt_s, coordinates.x[LOAD_VELOCITY])?;
        integrator::advance(self, coordinates, mode, torque_nm, dt_s, substeps)
    }

    fn positions(&self, state: &BacklashShaftState) -> Positions {
        coordinates::positions(state.coordinates.x.as_slice())
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
        let transmitted_nm = self.transmitted_torque_nm(at, mode.contact);
        let elastic_j = self.potential_energy_j(at) + bristle_energy_j;
        let motor_drive_nm = self.motor_drive_nm(at, mode.contact);
        let x = at.x.fixed_rows::<6>(0).into_owned();
        let truth = self.mechanics.truth(&x, at.motor_torque_nm, transmitted_nm, elastic_j, mode.contact);
        let outer_j = self.load_mode.map_or(0.0, |mode| mode.kinetic_j(at.outer, load_velocity));
        Truth {
            kinetic_energy_j: truth.kinetic_energy_j + outer_j,
            load_torque_nm: at.surroundings.load_torque_nm,
            gap_position_rad: at.gap_position_rad,
            load_friction: mode.load,
            motor_friction: mode.motor,
            load_dry_friction_nm,
            motor_dry_friction_nm: self.motor_friction.torque_nm(mode.motor, motor_velocity, motor_drive_nm),
            dead_zone_rad: at.surroundings.dead_zone_rad,
            ..truth
        }
    }

    fn judged_load_position_rad(&self, state: &BacklashShaftState) -> f64 {
        let at = &state.coordinates;
        if self.load_mode.is_some() { at.outer.position_rad } else { at.x[LOAD_POSITION] }
    }

    /// A gap that widens under a twisted shaft lets the shaft unwind; the energy set free counts as dissipated.
    fn set_environment(
        &self,
        state: &mut BacklashShaftState,
        environment: Environment,
    ) -> Result<(), PlantError> {
        let surroundings = Surroundings {
            dead_zone_rad: self.mechanics.dead_zone_rad + environment.gap_growth_rad,
            load_torque_nm: environment.load_torque_nm,
        };
        surroundings.validate()?;
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

    fn change_parameters(
        &mut self,
        state: &mut BacklashShaftState,
        release: &Release<'_>,
    ) -> Result<(), PlantError> {
        self.replace(&mut state.coordinates, Self::of(release)?);
        Ok(())
    }
}

impl BacklashShaft {
    /// Energy in the springs and in the motor's field, in J.
    fn potential_energy_j(&self, at: &ShaftCoordinates) -> f64 {
        let load_mode_j = self.load_mode.map_or(0.0, |mode| mode.elastic_j(at.outer, at.x[LOAD_POSITION]));
        self.shaft_energy_j(at) + self.cogging.energy_j(at.x[MOTOR_POSITION]) + load_mode_j
    }

    /// Replaces the parameters. The potential energy that the change sets free counts as dissipated, the energy it binds as
    /// negative dissipation.
    fn replace(&mut self, coordinates: &mut ShaftCoordinates, parameters: Self) {
        coordinates.x[DISSIPATED] +=
            self.potential_energy_j(coordinates) - parameters.potential_energy_j(coordinates);
        *self = parameters;
    }
}

impl RunningPlant<BacklashShaft> {
    /// Imposes wear and load torque from now on.
    ///
    /// # Errors
    /// Names the value outside its range.
    pub fn set_environment(&mut self, environment: Environment) -> Result<(), PlantError> {
        self.plant.set_environment(&mut self.state, environment)
    }

    /// Replaces the parameters from now on and keeps the state.
    pub fn change_parameters(&mut self, parameters: BacklashShaft) {
        self.plant.replace(&mut self.state.coordinates, parameters);
    }
}
