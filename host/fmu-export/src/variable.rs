//! Variables of an FMU and their values.

/// A value of a variable.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// A number in the variable's unit.
    Real(f64),
    /// A whole number.
    Integer(i32),
    /// True or false.
    Boolean(bool),
    /// A text.
    Text(String),
}

/// The type of a value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// `Real` in FMI 2.0, `Float64` in FMI 3.0.
    Real,
    /// `Integer` in FMI 2.0, `Int32` in FMI 3.0.
    Integer,
    /// `Boolean`.
    Boolean,
    /// `String`.
    Text,
}

impl Value {
    /// The type.
    #[must_use]
    pub const fn kind(&self) -> Kind {
        match self {
            Self::Real(_) => Kind::Real,
            Self::Integer(_) => Kind::Integer,
            Self::Boolean(_) => Kind::Boolean,
            Self::Text(_) => Kind::Text,
        }
    }

    /// The number of a real value, NaN for any other.
    pub(crate) const fn real(&self) -> f64 {
        if let Self::Real(number) = self { *number } else { f64::NAN }
    }

    /// The number of an integer, 0 for any other value.
    pub(crate) const fn integer(&self) -> i32 {
        if let Self::Integer(number) = self { *number } else { 0 }
    }
}

/// Who sets a variable, and when it changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Role {
    /// The time of the simulation.
    Time,
    /// The importer sets it, in every step.
    Input,
    /// The FMU sets it, with every step.
    Output,
    /// The importer sets it before the end of the initialization.
    Parameter,
}

/// A variable. Its value reference is its index in the list.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Variable {
    /// A key of the scenario, a column of a record, or `torque_nm`.
    pub(crate) name: String,
    pub(crate) role: Role,
    /// As the project writes units: `N m/rad`.
    pub(crate) unit: String,
    pub(crate) description: String,
    /// Its value before the importer sets it; of an output, only the type counts.
    pub(crate) start: Value,
}

impl Variable {
    pub(crate) fn new(
        role: Role,
        name: impl Into<String>,
        unit: &str,
        start: Value,
        description: &str,
    ) -> Self {
        Self { name: name.into(), role, unit: unit.to_owned(), description: description.to_owned(), start }
    }

    pub(crate) fn kind(&self) -> Kind {
        self.start.kind()
    }
}
