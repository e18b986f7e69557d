//! Contacts at the inputs of the drive: enable, limit switches, home switch.

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
