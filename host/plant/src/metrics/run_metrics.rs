//! All metrics of one run.

use serde::ser::{Serialize, SerializeMap, Serializer};

use super::measured::Measured;
use super::metric::Metric;

/// All metrics of one run. Serialised as a map from name to number or null.
#[derive(Debug, Clone, PartialEq)]
pub struct Metrics {
    pub(super) values: [Measured; Metric::ALL.len()],
    pub(super) finite: bool,
}

impl Metrics {
    /// One metric.
    #[must_use]
    pub const fn get(&self, metric: Metric) -> Measured {
        self.values[metric as usize]
    }

    /// Whether every position, reference and torque of the run was finite.
    #[must_use]
    pub const fn run_was_finite(&self) -> bool {
        self.finite
    }

    /// Every metric with its value, in the order of reports.
    pub fn iter(&self) -> impl Iterator<Item = (Metric, Measured)> {
        Metric::ALL.into_iter().zip(self.values)
    }
}

impl Serialize for Metrics {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.values.len()))?;
        for (metric, measured) in self.iter() {
            map.serialize_entry(metric.name(), &measured)?;
        }
        map.end()
    }
}
