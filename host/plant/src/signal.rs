//! A named quantity with its unit: one column of a record.

use std::borrow::Cow;

/// A quantity that a plant or a drive reports at every step.
#[derive(Debug, Clone, PartialEq, Eq, Hash, serde::Serialize)]
pub struct Signal {
    /// Name, unique among the signals of its source; it ends with the unit, such as `twist_rad`.
    pub name: Cow<'static, str>,
    /// Unit as an engineer writes it, such as `N m s/rad`; empty for a pure number.
    pub unit: Cow<'static, str>,
}

impl Signal {
    /// A signal whose name is known when the program is built.
    #[must_use]
    pub const fn new(name: &'static str, unit: &'static str) -> Self {
        Self { name: Cow::Borrowed(name), unit: Cow::Borrowed(unit) }
    }
}
