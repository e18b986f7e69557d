//! The modes of a plant: which side is in contact, and which masses stick.

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
    /// The side on which `value` lies outside `-half_width..=half_width`.
    pub(crate) fn outside(value: f64, half_width: f64) -> Self {
        if value > half_width {
            Self::Positive
        } else if value < -half_width {
            Self::Negative
        } else {
            Self::Gap
        }
    }

    /// -1, 0 or +1.
    pub fn sign(self) -> f64 {
        match self {
            Self::Negative => -1.0,
            Self::Gap => 0.0,
            Self::Positive => 1.0,
        }
    }
}

/// A flank of the gap.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Flank {
    /// Where the motor pushes towards negative angles.
    Lower,
    /// Where the motor pushes towards positive angles.
    Upper,
}

impl Flank {
    /// The contact at this flank.
    pub fn side(self) -> Contact {
        match self {
            Self::Lower => Contact::Negative,
            Self::Upper => Contact::Positive,
        }
    }
}

/// State of a mass under dry friction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DryFriction {
    /// The mass is at rest, and friction balances the driving torque.
    Stick,
    /// The mass moves, or is about to, towards negative angles.
    SlipNegative,
    /// The mass moves, or is about to, towards positive angles; also the state of a mass without dry friction.
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

    /// State of a mass at rest. The limits are its stiction against a negative and against a positive driving torque.
    pub(crate) fn at_rest(drive_nm: f64, [negative_nm, positive_nm]: [f64; 2]) -> Self {
        if drive_nm > positive_nm {
            Self::SlipPositive
        } else if drive_nm < -negative_nm {
            Self::SlipNegative
        } else {
            Self::Stick
        }
    }

    /// Guard of this state, with the limits of [`DryFriction::at_rest`]: not negative while the state holds.
    #[inline]
    pub(crate) fn guard(self, velocity_rad_s: f64, drive_nm: f64, limits_nm: [f64; 2]) -> f64 {
        match self {
            Self::SlipPositive => velocity_rad_s,
            Self::SlipNegative => -velocity_rad_s,
            Self::Stick => {
                let [negative_nm, positive_nm] = limits_nm;
                if drive_nm < 0.0 { negative_nm + drive_nm } else { positive_nm - drive_nm }
            }
        }
    }

    /// State of a mass that is released with this velocity under this driving torque.
    pub(crate) fn released(velocity_rad_s: f64, drive_nm: f64, limits_nm: [f64; 2]) -> Self {
        if velocity_rad_s > 0.0 {
            Self::SlipPositive
        } else if velocity_rad_s < 0.0 {
            Self::SlipNegative
        } else {
            Self::at_rest(drive_nm, limits_nm)
        }
    }
}
