//! What all profiles share: the two masses, and the order of their coordinates.

use nalgebra::Vector4;

use crate::plant::ParameterError;
use crate::plant::error::within;
use crate::plant::truth::{Contact, LoadFriction, Truth};

/// Index of the load position in a state vector.
pub(crate) const LOAD_POSITION: usize = 0;
/// Index of the load velocity in a state vector.
pub(crate) const LOAD_VELOCITY: usize = 1;
/// Index of the motor position in a state vector.
pub(crate) const MOTOR_POSITION: usize = 2;
/// Index of the motor velocity in a state vector.
pub(crate) const MOTOR_VELOCITY: usize = 3;

/// True parameters of motor, reducer and load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mechanics {
    /// Motor inertia J_m in kg m^2.
    pub motor_inertia_kg_m2: f64,
    /// Viscous friction of the motor f_m in N m s/rad.
    pub motor_friction_nm_s_rad: f64,
    /// Load inertia J_s in kg m^2.
    pub load_inertia_kg_m2: f64,
    /// Viscous friction of the load f_s in N m s/rad.
    pub load_friction_nm_s_rad: f64,
    /// Reduction ratio N0.
    pub ratio: f64,
    /// Stiffness K in N m/rad, seen at the motor.
    pub stiffness_nm_rad: f64,
    /// Dead-zone amplitude j0 in rad, half the gap.
    pub dead_zone_rad: f64,
}

/// Where a plant is released, and how fast it moves then.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Start {
    /// Load position theta_s in rad.
    pub load_position_rad: f64,
    /// Load velocity in rad/s.
    pub load_velocity_rad_s: f64,
    /// Motor position theta_e in rad.
    pub motor_position_rad: f64,
    /// Motor velocity in rad/s.
    pub motor_velocity_rad_s: f64,
}

impl Start {
    /// Released without a push.
    pub const fn at_rest(load_position_rad: f64, motor_position_rad: f64) -> Self {
        Self { load_position_rad, load_velocity_rad_s: 0.0, motor_position_rad, motor_velocity_rad_s: 0.0 }
    }

    /// The coordinates of it.
    pub(crate) fn coordinates(&self) -> Vector4<f64> {
        let Self { load_position_rad, load_velocity_rad_s, motor_position_rad, motor_velocity_rad_s } = *self;
        Vector4::new(load_position_rad, load_velocity_rad_s, motor_position_rad, motor_velocity_rad_s)
    }
}

impl Mechanics {
    /// Table 1 of the paper (Control Engineering Practice 13 (2005) 973-983).
    pub fn paper() -> Self {
        Self {
            motor_inertia_kg_m2: 9.72e-4,
            motor_friction_nm_s_rad: 4.3e-4,
            load_inertia_kg_m2: 7.5,
            load_friction_nm_s_rad: 16.0,
            ratio: 3.0,
            stiffness_nm_rad: 1.0,
            dead_zone_rad: 0.16,
        }
    }

    /// Checks every parameter.
    ///
    /// # Errors
    /// Names the first parameter outside its range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        within("motor_inertia_kg_m2", self.motor_inertia_kg_m2, 1e-9, 1e3)?;
        within("motor_friction_nm_s_rad", self.motor_friction_nm_s_rad, 0.0, 1e4)?;
        within("load_inertia_kg_m2", self.load_inertia_kg_m2, 1e-9, 1e6)?;
        within("load_friction_nm_s_rad", self.load_friction_nm_s_rad, 0.0, 1e6)?;
        within("ratio", self.ratio, 1e-3, 1e4)?;
        within("stiffness_nm_rad", self.stiffness_nm_rad, 1e-6, 1e9)?;
        within("dead_zone_rad", self.dead_zone_rad, 1e-6, 10.0)
    }

    /// Twist z in rad.
    pub(crate) fn twist_rad(&self, x: &Vector4<f64>) -> f64 {
        x[MOTOR_POSITION] - self.ratio * x[LOAD_POSITION]
    }

    /// Rates of change when the load moves freely, equation (6), with dry friction as a given torque on the load.
    pub(crate) fn rates(
        &self,
        x: &Vector4<f64>,
        transmitted_nm: f64,
        torque_nm: f64,
        dry_nm: f64,
    ) -> Vector4<f64> {
        let load = self.ratio * transmitted_nm - self.load_friction_nm_s_rad * x[LOAD_VELOCITY] - dry_nm;
        let motor = torque_nm - transmitted_nm - self.motor_friction_nm_s_rad * x[MOTOR_VELOCITY];
        Vector4::new(
            x[LOAD_VELOCITY],
            load / self.load_inertia_kg_m2,
            x[MOTOR_VELOCITY],
            motor / self.motor_inertia_kg_m2,
        )
    }

    /// Everything about a state, from what the profile knows of its dead zone and friction.
    pub(crate) fn truth(
        &self,
        x: &Vector4<f64>,
        transmitted_torque_nm: f64,
        elastic_energy_j: f64,
        contact: Contact,
        load_friction: LoadFriction,
    ) -> Truth {
        let twist_rad = self.twist_rad(x);
        Truth {
            load_position_rad: x[LOAD_POSITION],
            load_velocity_rad_s: x[LOAD_VELOCITY],
            motor_position_rad: x[MOTOR_POSITION],
            motor_velocity_rad_s: x[MOTOR_VELOCITY],
            twist_rad,
            transmitted_torque_nm,
            gap_position_rad: twist_rad - transmitted_torque_nm / self.stiffness_nm_rad,
            contact,
            load_friction,
            kinetic_energy_j: 0.5
                * (self.load_inertia_kg_m2 * x[LOAD_VELOCITY] * x[LOAD_VELOCITY]
                    + self.motor_inertia_kg_m2 * x[MOTOR_VELOCITY] * x[MOTOR_VELOCITY]),
            elastic_energy_j,
            dead_zone_rad: self.dead_zone_rad,
        }
    }
}
