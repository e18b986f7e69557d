//! The two masses and the spring of every plant.

use std::ops::RangeInclusive;

use nalgebra::Vector6;

use crate::ParameterError;
use crate::coordinates::{
    DISSIPATED, LOAD_POSITION, LOAD_VELOCITY, MOTOR_POSITION, MOTOR_VELOCITY, SUPPLIED,
};
use crate::error::within;
use crate::mode::{Contact, DryFriction};
use crate::truth::Truth;

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

/// Checks a parameter against its range.
pub(crate) fn in_range(
    name: &'static str,
    value: f64,
    range: &RangeInclusive<f64>,
) -> Result<(), ParameterError> {
    within(name, value, *range.start(), *range.end())
}

impl Mechanics {
    /// Allowed motor inertia.
    pub const MOTOR_INERTIA_KG_M2: RangeInclusive<f64> = 1e-9..=1e3;
    /// Allowed viscous friction of the motor.
    pub const MOTOR_FRICTION_NM_S_RAD: RangeInclusive<f64> = 0.0..=1e4;
    /// Allowed load inertia.
    pub const LOAD_INERTIA_KG_M2: RangeInclusive<f64> = 1e-9..=1e6;
    /// Allowed viscous friction of the load.
    pub const LOAD_FRICTION_NM_S_RAD: RangeInclusive<f64> = 0.0..=1e6;
    /// Allowed reduction ratio.
    pub const RATIO: RangeInclusive<f64> = 1e-3..=1e4;
    /// Allowed stiffness.
    pub const STIFFNESS_NM_RAD: RangeInclusive<f64> = 1e-6..=1e9;
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
        in_range("motor_inertia_kg_m2", self.motor_inertia_kg_m2, &Self::MOTOR_INERTIA_KG_M2)?;
        in_range("motor_friction_nm_s_rad", self.motor_friction_nm_s_rad, &Self::MOTOR_FRICTION_NM_S_RAD)?;
        in_range("load_inertia_kg_m2", self.load_inertia_kg_m2, &Self::LOAD_INERTIA_KG_M2)?;
        in_range("load_friction_nm_s_rad", self.load_friction_nm_s_rad, &Self::LOAD_FRICTION_NM_S_RAD)?;
        in_range("ratio", self.ratio, &Self::RATIO)?;
        in_range("stiffness_nm_rad", self.stiffness_nm_rad, &Self::STIFFNESS_NM_RAD)?;
        in_range("dead_zone_rad", self.dead_zone_rad, &Self::DEAD_ZONE_RAD)
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
