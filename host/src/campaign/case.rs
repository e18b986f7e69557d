//! One run of a campaign and its position in the tables.

use std::fmt;

use lashloop_bench::scenario::Scenario;
use serde::{Deserialize, Serialize};

use super::law::Law;

/// A table of the campaign.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Part {
    /// Plants with random parameters.
    RandomPlants,
    /// The nominal plant, dead zone varied.
    DeadZone,
    /// The nominal plant, encoder resolution varied.
    EncoderCounts,
    /// The nominal plant, torque limit varied.
    TorqueLimit,
    /// The nominal plant, torque delay varied.
    TorqueDelay,
}

impl fmt::Display for Part {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.serialize(out)
    }
}

/// Position of a run in the tables.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CaseId {
    pub part: Part,
    /// Number of the plant or of the varied value, from 0.
    pub row: u32,
    pub law: Law,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    pub id: CaseId,
    /// Changes to the law's scenario, in the form of `--set`.
    pub settings: Vec<String>,
    pub scenario: Scenario,
}

impl fmt::Display for CaseId {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { part, row, law } = self;
        write!(out, "{law} in row {row} of {part}")
    }
}
