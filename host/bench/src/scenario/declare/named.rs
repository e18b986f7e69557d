//! Types whose values have names in files.

use lashloop_plant::metrics::{Metric, Statistic};
use lashloop_plant::reference::Interpolation;

use crate::scenario::key::Choice;

/// A type whose values have names in files.
pub trait Named: Copy + PartialEq + 'static {
    /// The values, in the order of documents.
    const ALL: &'static [Self];

    /// The name of a value, with its meaning.
    fn choice(self) -> Choice;

    /// The value of a name.
    #[must_use]
    fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|value| value.choice().name == name)
    }
}

impl Named for Metric {
    const ALL: &'static [Self] = &Self::ALL;

    fn choice(self) -> Choice {
        // The page of metrics has the meanings.
        Choice { name: self.name(), doc: "" }
    }
}

impl Named for Statistic {
    const ALL: &'static [Self] = &Self::ALL;

    fn choice(self) -> Choice {
        Choice { name: self.name(), doc: self.meaning() }
    }
}

impl Named for Interpolation {
    const ALL: &'static [Self] = &[Self::Linear, Self::Hold];

    fn choice(self) -> Choice {
        let name = match self {
            Self::Linear => "linear",
            Self::Hold => "hold",
        };
        Choice { name, doc: "" }
    }
}
