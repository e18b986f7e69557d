//! A variable of an FMU.

/// Type of a variable.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Float64,
    Float32,
    Int8,
    UInt8,
    Int16,
    UInt16,
    Int32,
    UInt32,
    Int64,
    UInt64,
    Boolean,
    Text,
    /// A binary, a clock, or a type of a later version.
    Other,
}

impl Kind {
    /// The type by its element in the XML of FMI 1.0, 2.0 (`is_three` is false) or 3.0.
    pub(crate) fn of_element(element: &str, is_three: bool) -> Self {
        match element {
            "Real" | "Float64" => Self::Float64,
            "Enumeration" if is_three => Self::Int64,
            "Integer" | "Enumeration" | "Int32" => Self::Int32,
            "Float32" => Self::Float32,
            "Int8" => Self::Int8,
            "UInt8" => Self::UInt8,
            "Int16" => Self::Int16,
            "UInt16" => Self::UInt16,
            "UInt32" => Self::UInt32,
            "Int64" => Self::Int64,
            "UInt64" => Self::UInt64,
            "Boolean" => Self::Boolean,
            "String" => Self::Text,
            _ => Self::Other,
        }
    }

    /// Whether it is one of floating-point numbers.
    pub(crate) fn is_float(self) -> bool {
        matches!(self, Self::Float64 | Self::Float32)
    }

    /// Whether its values are numbers, true and false counting as 1 and 0.
    pub(crate) fn is_number(self) -> bool {
        !matches!(self, Self::Text | Self::Other)
    }
}

/// A variable.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Variable {
    pub(crate) name: String,
    /// Value reference.
    pub(crate) reference: u32,
    pub(crate) kind: Kind,
    /// The element or type in the XML.
    pub(crate) type_name: String,
    /// `input`, `output`, `parameter` and so on.
    pub(crate) causality: String,
    /// Empty if the XML has none.
    pub(crate) unit: String,
    /// Start value as the XML has it.
    pub(crate) start: Option<String>,
    /// Whether the FMU may change its start value while it initializes.
    pub(crate) is_approximate: bool,
    pub(crate) is_array: bool,
}

impl Variable {
    /// `a Real of causality "local"`, for messages.
    pub(crate) fn describe(&self) -> String {
        let array = if self.is_array { "an array of type" } else { "of type" };
        let unit = if self.unit.is_empty() { String::new() } else { format!(", unit {:?}", self.unit) };
        format!("{array} {}, causality {:?}{unit}", self.type_name, self.causality)
    }
}
