//! The true quantities of a plant. The record contains them; the drive never receives them.

use crate::Signal;
use crate::mode::{Contact, DryFriction};

/// Everything that can be known about a state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Truth {
    /// Load position theta_s in rad.
    pub load_position_rad: f64,
    /// Load velocity in rad/s; exactly zero while the load sticks.
    pub load_velocity_rad_s: f64,
    /// Motor position theta_e in rad.
    pub motor_position_rad: f64,
    /// Motor velocity in rad/s.
    pub motor_velocity_rad_s: f64,
    /// Torque tau at the motor in N m, after saturation and lag. At a jump, the torque before it.
    pub motor_torque_nm: f64,
    /// External torque T on the load in N m.
    pub load_torque_nm: f64,
    /// Twist z = theta_e - N0 theta_s in rad.
    pub twist_rad: f64,
    /// Transmitted torque C in N m, at the motor's side of the reducer.
    pub transmitted_torque_nm: f64,
    /// Disturbing torque w = C - K z in N m, equation (2) of the paper: the difference from a spring without a gap.
    pub disturbing_torque_nm: f64,
    /// Position in the gap in rad: theta_b of the backlash shaft, z - C / K of the other plants. Within +-j0 on a hard
    /// gap, within +-4 j0 on the smooth one.
    pub gap_position_rad: f64,
    /// Side that carries torque; on a smooth dead zone the sign of C.
    pub contact: Contact,
    /// Dry-friction state of the load.
    pub load_friction: DryFriction,
    /// Dry-friction state of the motor.
    pub motor_friction: DryFriction,
    /// Dry friction F_L on the load in N m, against positive motion; the driving torque while the load sticks.
    pub load_dry_friction_nm: f64,
    /// Dry friction F_M on the motor in N m, against positive motion; the driving torque while the motor sticks.
    pub motor_dry_friction_nm: f64,
    /// Kinetic energy of both masses in J.
    pub kinetic_energy_j: f64,
    /// Energy stored in the spring, and in the bristles of LuGre friction, in J.
    pub elastic_energy_j: f64,
    /// Work of motor torque and load torque since the start, in J.
    pub supplied_energy_j: f64,
    /// Energy lost to friction, damping and wear since the start, in J.
    pub dissipated_energy_j: f64,
    /// True dead-zone amplitude j0 in rad.
    pub dead_zone_rad: f64,
}

impl Truth {
    /// Energy stored in masses and springs in J. Its change equals the energy supplied minus the energy dissipated.
    pub fn energy_j(&self) -> f64 {
        self.kinetic_energy_j + self.elastic_energy_j
    }
}

/// Signals of every plant of two masses, in the order of [`Truth::values`].
pub(crate) static SIGNALS: [Signal; 17] = [
    Signal::new("load_velocity_rad_s", "rad/s"),
    Signal::new("motor_velocity_rad_s", "rad/s"),
    Signal::new("transmitted_torque_nm", "N m"),
    Signal::new("twist_rad", "rad"),
    Signal::new("dead_zone_rad", "rad"),
    Signal::new("gap_position_rad", "rad"),
    Signal::new("contact", ""),
    Signal::new("motor_torque_nm", "N m"),
    Signal::new("load_torque_nm", "N m"),
    Signal::new("load_dry_friction_nm", "N m"),
    Signal::new("motor_dry_friction_nm", "N m"),
    Signal::new("load_sticks", ""),
    Signal::new("motor_sticks", ""),
    Signal::new("stored_energy_j", "J"),
    Signal::new("supplied_energy_j", "J"),
    Signal::new("dissipated_energy_j", "J"),
    Signal::new("disturbing_torque_nm", "N m"),
];

impl Truth {
    /// The values of [`SIGNALS`]. Contact is -1, 0 or 1; a mass sticks with 1 and slips with 0.
    pub(crate) fn values(&self) -> [f64; SIGNALS.len()] {
        let sticks = |friction| f64::from(friction == DryFriction::Stick);
        [
            self.load_velocity_rad_s,
            self.motor_velocity_rad_s,
            self.transmitted_torque_nm,
            self.twist_rad,
            self.dead_zone_rad,
            self.gap_position_rad,
            self.contact.sign(),
            self.motor_torque_nm,
            self.load_torque_nm,
            self.load_dry_friction_nm,
            self.motor_dry_friction_nm,
            sticks(self.load_friction),
            sticks(self.motor_friction),
            self.energy_j(),
            self.supplied_energy_j,
            self.dissipated_energy_j,
            self.disturbing_torque_nm,
        ]
    }
}
