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

/// Whether the load's dry friction holds it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LoadFriction {
    /// The load stands, and friction balances what drives it.
    Stick,
    /// The load moves, or is about to, towards negative angles.
    SlipNegative,
    /// The load moves, or is about to, towards positive angles; also where there is no dry friction at all.
    SlipPositive,
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
    /// Twist z = theta_e - N0 theta_s in rad.
    pub twist_rad: f64,
    /// Transmitted torque C in N m, at the motor's side of the reducer.
    pub transmitted_torque_nm: f64,
    /// Part of the twist taken up by the gap, z - C / K, in rad: within +-j0 on a hard gap, within +-4 j0 on the
    /// smooth one.
    pub gap_position_rad: f64,
    /// Side that carries torque; on a smooth dead zone the sign of C.
    pub contact: Contact,
    /// Whether the load sticks.
    pub load_friction: LoadFriction,
    /// Kinetic energy of both masses in J.
    pub kinetic_energy_j: f64,
    /// Energy stored in the spring in J.
    pub elastic_energy_j: f64,
    /// True dead-zone amplitude j0 in rad.
    pub dead_zone_rad: f64,
}

impl Truth {
    /// Kinetic and elastic energy in J.
    pub fn energy_j(&self) -> f64 {
        self.kinetic_energy_j + self.elastic_energy_j
    }
}
