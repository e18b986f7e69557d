//! Contacts at the inputs of the drive: enable, limit switches, home switch; and index pulses of its encoders.

/// Contacts that are closed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Contacts {
    /// Enable input.
    pub enable: bool,
    /// Limit switch towards negative positions.
    pub negative_limit: bool,
    /// Limit switch towards positive positions.
    pub positive_limit: bool,
    /// Home switch.
    pub home: bool,
}

crate::choices! {
    /// What a contact says by being closed.
    pub enum Contact {
        /// Nothing: none is wired.
        Unused = "unused",
        /// A closed contact is active.
        Closed = "closed",
        /// An open contact is active, and so is a broken wire.
        Open = "open",
    }
}

crate::choices! {
    /// The encoder whose index pulse is at its zero.
    pub enum IndexInput {
        /// None.
        Unused = "unused",
        /// That at the motor.
        Motor = "motor",
        /// That at the load.
        Load = "load",
    }
}

impl IndexInput {
    /// Place of its encoder among motor and load.
    #[must_use]
    pub const fn side(self) -> Option<usize> {
        match self {
            Self::Unused => None,
            Self::Motor => Some(0),
            Self::Load => Some(1),
        }
    }
}

impl Contact {
    /// Whether the contact is active; `None` if none is wired.
    #[must_use]
    pub const fn is_active(self, is_closed: bool) -> Option<bool> {
        match self {
            Self::Unused => None,
            Self::Closed => Some(is_closed),
            Self::Open => Some(!is_closed),
        }
    }
}
