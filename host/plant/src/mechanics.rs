//! The two masses and the spring of every plant, and their keys. The defaults are table 1 of the paper.

use std::f64::consts::PI;
use std::ops::RangeInclusive;

use nalgebra::Vector6;

use crate::coordinates::{
    DISSIPATED, LOAD_POSITION, LOAD_VELOCITY, MOTOR_POSITION, MOTOR_VELOCITY, SUPPLIED,
};
use crate::limits::MAX_SUBSTEPS;
use crate::mode::{Contact, DryFriction};
use crate::numbers::numbers;
use crate::truth::Truth;
use crate::{Key, ParameterError};

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

// The keys of stiffness and dead zone are narrower than the plant's ranges: faults change both during the run.
numbers! { Mechanics, paper, it:
    motor_inertia_kg_m2: "motor_inertia_kg_m2", "kg m^2", 1e-9..=1e3, "Inertia J_m of the motor.";
    motor_friction_nm_s_rad: "motor_friction_nm_s_rad", "N m s/rad", 0.0..=1e4, "Viscous friction f_m of the motor.";
    load_inertia_kg_m2: "load_inertia_kg_m2", "kg m^2", 1e-9..=1e6, "Inertia J_s of the load.";
    load_friction_nm_s_rad: "load_friction_nm_s_rad", "N m s/rad", 0.0..=1e6, "Viscous friction f_s of the load.";
    ratio: "ratio" as "reduction_ratio", "", 1e-3..=1e4, "Reduction ratio N0, motor revolutions per load revolution.";
    stiffness_nm_rad: "stiffness_nm_rad", "N m/rad", 1e-6..=1e9, given 1e-6..=1e6,
        "Stiffness K between motor and load, at the motor.";
    dead_zone_rad: "dead_zone_rad", "rad", Self::DEAD_ZONE_RAD, given *Self::DEAD_ZONE_RAD.start()..=PI,
        "Half gap j0, at the motor.";
}

/// Keys of a plant of two masses that is integrated in `substeps` substeps by default.
pub(crate) fn keys(substeps: u32) -> Vec<Key> {
    let [motor_inertia, motor_friction, load_inertia, load_friction, ratio, stiffness, dead_zone] =
        Mechanics::keys();
    let substeps =
        Key::integer("substeps", "", substeps, 1..=MAX_SUBSTEPS, "Integration steps per control period.");
    vec![substeps, load_inertia, load_friction, motor_inertia, motor_friction, ratio, stiffness, dead_zone]
}

impl Mechanics {
    /// Allowed dead-zone amplitude.
    pub const DEAD_ZONE_RAD: RangeInclusive<f64> = 1e-6..=10.0;

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
        self.check()
    }

    /// Twist z in rad.
    pub(crate) fn twist_rad(&self, x: &Vector6<f64>) -> f64 {
        self.twist_of(x[LOAD_POSITION], x[MOTOR_POSITION])
    }

    /// Twist z in rad at these positions.
    #[inline]
    pub(crate) fn twist_of(&self, load_position_rad: f64, motor_position_rad: f64) -> f64 {
        motor_position_rad - self.ratio * load_position_rad
    }

    /// Rates of change while the load moves, equation (6), with dry friction as a given torque on the load. The last two
    /// are the power supplied and the power dissipated.
    #[inline]
    pub(crate) fn rates(
        &self,
        x: &Vector6<f64>,
        transmitted_nm: f64,
        torque_nm: f64,
        dry_nm: f64,
    ) -> Vector6<f64> {
        let load = self.ratio * transmitted_nm - self.load_friction_nm_s_rad * x[LOAD_VELOCITY] - dry_nm;
        let motor = torque_nm - transmitted_nm - self.motor_friction_nm_s_rad * x[MOTOR_VELOCITY];
        let dissipated_w = (self.load_friction_nm_s_rad * x[LOAD_VELOCITY] + dry_nm) * x[LOAD_VELOCITY]
            + self.motor_friction_nm_s_rad * x[MOTOR_VELOCITY] * x[MOTOR_VELOCITY];
        Vector6::new(
            x[LOAD_VELOCITY],
            load / self.load_inertia_kg_m2,
            x[MOTOR_VELOCITY],
            motor / self.motor_inertia_kg_m2,
            torque_nm * x[MOTOR_VELOCITY],
            dissipated_w,
        )
    }

    /// Kinetic energy of both masses in J.
    pub(crate) fn kinetic_energy_j(&self, load_velocity_rad_s: f64, motor_velocity_rad_s: f64) -> f64 {
        0.5 * (self.load_inertia_kg_m2 * load_velocity_rad_s * load_velocity_rad_s
            + self.motor_inertia_kg_m2 * motor_velocity_rad_s * motor_velocity_rad_s)
    }

    /// The truth of a plant without dry friction that transmits `transmitted_torque_nm` with `elastic_energy_j` in its
    /// spring.
    pub(crate) fn truth(
        &self,
        x: &Vector6<f64>,
        motor_torque_nm: f64,
        transmitted_torque_nm: f64,
        elastic_energy_j: f64,
        contact: Contact,
    ) -> Truth {
        let twist_rad = self.twist_rad(x);
        Truth {
            load_position_rad: x[LOAD_POSITION],
            load_velocity_rad_s: x[LOAD_VELOCITY],
            motor_position_rad: x[MOTOR_POSITION],
            motor_velocity_rad_s: x[MOTOR_VELOCITY],
            motor_torque_nm,
            load_torque_nm: 0.0,
            twist_rad,
            transmitted_torque_nm,
            disturbing_torque_nm: transmitted_torque_nm - self.stiffness_nm_rad * twist_rad,
            gap_position_rad: twist_rad - transmitted_torque_nm / self.stiffness_nm_rad,
            contact,
            load_friction: DryFriction::SlipPositive,
            motor_friction: DryFriction::SlipPositive,
            load_dry_friction_nm: 0.0,
            motor_dry_friction_nm: 0.0,
            kinetic_energy_j: self.kinetic_energy_j(x[LOAD_VELOCITY], x[MOTOR_VELOCITY]),
            elastic_energy_j,
            supplied_energy_j: x[SUPPLIED],
            dissipated_energy_j: x[DISSIPATED],
            dead_zone_rad: self.dead_zone_rad,
        }
    }
}
