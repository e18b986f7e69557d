//! A value with its bounds, as the journal of a suite and its page have it.

use lashloop_bench::verdict::JudgedExpectation;
use serde::{Deserialize, Serialize};

use super::margin::{Grade, Margin};

/// A value with its bounds: an expectation of the scenario, or a metric against its baseline.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Check {
    /// What is judged.
    pub name: String,
    /// Its value; `None` without one.
    pub value: Option<f64>,
    /// Smallest value that passes.
    pub min: Option<f64>,
    /// Largest value that passes.
    pub max: Option<f64>,
    /// The unit.
    pub unit: String,
    /// Whether it is met.
    pub ok: bool,
}

impl Check {
    pub(super) fn margin(&self) -> Option<Margin> {
        Margin::of(self.value?, self.min, self.max)
    }

    pub(super) fn grade(&self) -> Grade {
        Grade::of(self.ok, self.margin())
    }
}

impl From<&JudgedExpectation> for Check {
    fn from(judged: &JudgedExpectation) -> Self {
        let JudgedExpectation { value, unit, min, max, ok, .. } = judged;
        Self { name: judged.name(), value: value.value(), min: *min, max: *max, unit: unit.clone(), ok: *ok }
    }
}
