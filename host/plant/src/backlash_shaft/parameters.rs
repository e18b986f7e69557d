//! Parameters of shaft damping, dry friction and drive.

use std::ops::RangeInclusive;

use crate::ParameterError;
use crate::error::{in_range, within};
use crate::numbers::numbers;

/// Parameters of the backlash shaft beyond masses and spring.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShaftParameters {
    /// Damping c of the shaft in N m s/rad, in parallel with its spring; 3.1e-3 is 5 % of critical. Without damping the gap is
    /// that of the hard-coulomb plant.
    pub shaft_damping_nm_s_rad: f64,
    /// Dry friction on the load.
    pub load: StribeckParameters,
    /// Fraction by which friction on the load is larger forwards and smaller backwards.
    pub load_asymmetry: f64,
    /// Bristles that make the load's friction LuGre friction; `None` for Stribeck friction.
    pub load_bristles: Option<BristleParameters>,
    /// The load as two masses; one mass if no part of it is behind the spring.
    pub load_mode: LoadModeParameters,
    /// Dry friction on the motor.
    pub motor: StribeckParameters,
    /// Fraction by which friction on the motor is larger forwards and smaller backwards.
    pub motor_asymmetry: f64,
    /// Torque of the motor without current.
    pub cogging: CoggingParameters,
    /// Torque in N m that the drive adds to every command.
    pub torque_offset_nm: f64,
    /// Lag T_i of the current loop in s; zero for an ideal one.
    pub current_lag_s: f64,
    /// Largest torque U_max of the motor in N m.
    pub torque_saturation_nm: f64,
}

/// Friction that falls from F_s at rest to F_c in motion: F_c + (F_s - F_c) exp(-(v / v_s)^2).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StribeckParameters {
    /// Coulomb friction F_c in N m.
    pub coulomb_nm: f64,
    /// Stiction F_s in N m, at least F_c.
    pub stiction_nm: f64,
    /// Stribeck velocity v_s in rad/s.
    pub velocity_rad_s: f64,
}

/// Bristles between load and ground (Canudas de Wit, Olsson, Astrom, Lischinsky 1995).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BristleParameters {
    /// sigma_0 in N m/rad.
    pub stiffness_nm_rad: f64,
    /// sigma_1 in N m s/rad.
    pub damping_nm_s_rad: f64,
}

/// A part of the load behind a spring.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoadModeParameters {
    /// Fraction of the load's inertia behind the spring; 0 for a rigid load.
    pub fraction: f64,
    /// Frequency in Hz at which both masses of the load swing against each other with the gap open, undamped.
    pub frequency_hz: f64,
    /// Damping of that oscillation as a ratio to critical damping.
    pub damping_ratio: f64,
}

/// A torque A sin(n theta_e) on the motor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoggingParameters {
    /// Amplitude A in N m.
    pub amplitude_nm: f64,
    /// Periods n per turn of the motor.
    pub per_turn: f64,
}

/// Allowed dry friction; stiction is at least the Coulomb friction.
const TORQUE_NM: RangeInclusive<f64> = 0.0..=1e6;
/// Allowed Stribeck velocity.
const VELOCITY_RAD_S: RangeInclusive<f64> = 1e-6..=1e3;

numbers! { ShaftParameters, paper, it:
    shaft_damping_nm_s_rad: "shaft_damping_nm_s_rad", "N m s/rad", 0.0..=1e6, "Shaft damping c, in parallel with the stiffness.";
    load.coulomb_nm: "load_coulomb_nm", "N m", TORQUE_NM, "Coulomb friction F_c of the load.";
    load.stiction_nm: "load_stiction_nm", "N m", it.load.coulomb_nm..=*TORQUE_NM.end(), given TORQUE_NM,
        "Stiction F_s of the load, from F_c.";
    load.velocity_rad_s: "load_stribeck_rad_s", "rad/s", VELOCITY_RAD_S, "Stribeck velocity v_s of the load.";
    load_asymmetry: "load_friction_asymmetry", "", -0.9..=0.9,
        "Fraction by which the load's friction is larger forwards and smaller backwards.";
    load_mode.fraction: "load_mode_fraction", "", 0.0..=0.95,
        "Fraction of the load's inertia behind a spring; 0 for a rigid load.";
    load_mode.frequency_hz: "load_mode_hz", "Hz", 0.1..=1e4, "Frequency of the load's two masses against each other.";
    load_mode.damping_ratio: "load_mode_damping", "", 0.0..=1.0, "Damping ratio of the load's two masses.";
    motor.coulomb_nm: "motor_coulomb_nm", "N m", TORQUE_NM, "Coulomb friction F_c of the motor.";
    motor.stiction_nm: "motor_stiction_nm", "N m", it.motor.coulomb_nm..=*TORQUE_NM.end(), given TORQUE_NM,
        "Stiction F_s of the motor, from F_c.";
    motor.velocity_rad_s: "motor_stribeck_rad_s", "rad/s", VELOCITY_RAD_S, "Stribeck velocity v_s of the motor.";
    motor_asymmetry: "motor_friction_asymmetry", "", -0.9..=0.9,
        "Fraction by which the motor's friction is larger forwards and smaller backwards.";
    cogging.amplitude_nm: "cogging_nm", "N m", 0.0..=1e3, "Amplitude A of the cogging torque A sin(n theta_e) of the motor.";
    cogging.per_turn: "cogging_per_turn", "", 1.0..=1e3, "Periods n of the cogging torque per turn of the motor.";
    torque_offset_nm: "torque_offset_nm", "N m", -1e3..=1e3, "Torque added to every command before saturation.";
    torque_saturation_nm: "torque_saturation_nm", "N m", Self::TORQUE_SATURATION_NM, "Limit U_max of the motor's torque.";
}

numbers! { BristleParameters, paper, it:
    stiffness_nm_rad: "bristle_stiffness_nm_rad", "N m/rad", 1e-3..=1e12, "Bristle stiffness sigma_0.";
    damping_nm_s_rad: "bristle_damping_nm_s_rad", "N m s/rad", 0.0..=1e9, "Bristle damping sigma_1.";
}

impl ShaftParameters {
    /// Allowed lag of the current loop.
    pub const CURRENT_LAG_S: RangeInclusive<f64> = 0.0..=10.0;
    /// Allowed torque limit.
    pub const TORQUE_SATURATION_NM: RangeInclusive<f64> = 1e-6..=1e6;

    /// Values that stand for the paper's experiment: with ideal sensors the cascaded PD law stops at 0.3204 rad, the paper's
    /// static error.
    pub fn paper() -> Self {
        Self {
            shaft_damping_nm_s_rad: 3.1e-3,
            load: StribeckParameters { coulomb_nm: 3.40, stiction_nm: 3.82, velocity_rad_s: 0.03 },
            load_asymmetry: 0.0,
            load_bristles: None,
            load_mode: LoadModeParameters { fraction: 0.0, frequency_hz: 10.0, damping_ratio: 0.02 },
            motor: StribeckParameters { coulomb_nm: 0.02, stiction_nm: 0.025, velocity_rad_s: 0.2 },
            motor_asymmetry: 0.0,
            cogging: CoggingParameters { amplitude_nm: 0.0, per_turn: 12.0 },
            torque_offset_nm: 0.0,
            current_lag_s: 5e-4,
            torque_saturation_nm: 20.0,
        }
    }

    /// Checks every parameter.
    ///
    /// # Errors
    /// Names the first parameter outside its range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        self.check()?;
        if let Some(bristles) = self.load_bristles {
            bristles.check()?;
            // Bristles slide at Coulomb friction; without it their deflection would have no limit.
            within("load_coulomb_nm", self.load.coulomb_nm, 1e-6, *TORQUE_NM.end())?;
        }
        in_range("current_lag_s", self.current_lag_s, &Self::CURRENT_LAG_S)
    }
}

impl BristleParameters {
    /// The defaults of the keys.
    fn paper() -> Self {
        Self { stiffness_nm_rad: 3.4e4, damping_nm_s_rad: 300.0 }
    }
}
