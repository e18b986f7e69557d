//! What only the plant knows.

/// The side of the dead zone that carries torque.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Contact {
    /// The motor pushes the load towards negative angles.
    Negative,
    /// Neither side carries torque.
    Gap,
    /// The motor pushes the load towards positive angles.
    Positive,
}

impl Contact {
    /// -1, 0 or +1.
    pub fn sign(self) -> f64 {
        match self {
            Self::Negative => -1.0,
            Self::Gap => 0.0,
            Self::Positive => 1.0,
        }
    }
}

/// Whether a mass is held by its dry friction, or else which way friction takes it to move.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DryFriction {
    /// The mass stands, and friction balances what drives it.
    Stick,
    /// The mass moves, or is about to, towards negative angles.
    SlipNegative,
    /// The mass moves, or is about to, towards positive angles; also where there is no dry friction at all.
    SlipPositive,
}

impl DryFriction {
    /// -1 or +1 for a mass that slips, 0 for one that sticks.
    pub fn sign(self) -> f64 {
        match self {
            Self::Stick => 0.0,
            Self::SlipNegative => -1.0,
            Self::SlipPositive => 1.0,
        }
    }

    /// The state of a mass at rest that sticks up to the first limit against a drive backwards, and up to the second
    /// against one forwards.
    pub(crate) fn at_rest(drive_nm: f64, [backwards_nm, forwards_nm]: [f64; 2]) -> Self {
        if drive_nm > forwards_nm {
            Self::SlipPositive
        } else if drive_nm < -backwards_nm {
            Self::SlipNegative
        } else {
            Self::Stick
        }
    }

    /// The state of a mass of which nothing is known but its velocity and what drives it.
    pub(crate) fn of(velocity_rad_s: f64, drive_nm: f64, limits_nm: [f64; 2]) -> Self {
        if velocity_rad_s > 0.0 {
            Self::SlipPositive
        } else if velocity_rad_s < 0.0 {
            Self::SlipNegative
        } else {
            Self::at_rest(drive_nm, limits_nm)
        }
    }
}

/// Everything there is to know about a state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Truth {
    /// Load position theta_s in rad.
    pub load_position_rad: f64,
    /// Load velocity in rad/s; exactly nought while the load sticks.
    pub load_velocity_rad_s: f64,
    /// Motor position theta_e in rad.
    pub motor_position_rad: f64,
    /// Motor velocity in rad/s.
    pub motor_velocity_rad_s: f64,
    /// Torque tau at the motor in N m, after saturation and lag. Where the torque jumps at this instant, the one before
    /// the jump.
    pub motor_torque_nm: f64,
    /// Torque on the load from outside, in N m.
    pub load_torque_nm: f64,
    /// Twist z = theta_e - N0 theta_s in rad.
    pub twist_rad: f64,
    /// Transmitted torque C in N m, at the motor's side of the reducer.
    pub transmitted_torque_nm: f64,
    /// Disturbing torque w = C - K z in N m: what the gap takes from a spring without one. Equation (2) of the paper.
    pub disturbing_torque_nm: f64,
    /// Position in the gap in rad: theta_b of the bench profile, elsewhere the part of the twist that the spring does not
    /// take, z - C / K. Within +-j0 on a hard gap, within +-4 j0 on the smooth one.
    pub gap_position_rad: f64,
    /// Side that carries torque; on a smooth dead zone the sign of C.
    pub contact: Contact,
    /// Whether the load sticks.
    pub load_friction: DryFriction,
    /// Whether the motor sticks.
    pub motor_friction: DryFriction,
    /// Dry friction F_L on the load in N m, against positive motion; what drives the load if it sticks.
    pub load_dry_friction_nm: f64,
    /// Dry friction F_M on the motor in N m, against positive motion; what drives the motor if it sticks.
    pub motor_dry_friction_nm: f64,
    /// Kinetic energy of both masses in J.
    pub kinetic_energy_j: f64,
    /// Energy stored in the spring, and in the bristles of LuGre friction, in J.
    pub elastic_energy_j: f64,
    /// Energy put in by motor torque and load torque since the start, in J.
    pub supplied_energy_j: f64,
    /// Energy lost to friction and damping since the start, in J.
    pub dissipated_energy_j: f64,
    /// True dead-zone amplitude j0 in rad.
    pub dead_zone_rad: f64,
}

impl Truth {
    /// Energy stored in masses and spring in J. It changes by what is supplied less what is dissipated.
    pub fn energy_j(&self) -> f64 {
        self.kinetic_energy_j + self.elastic_energy_j
    }
}
