//! One run of a campaign and its place in the tables.

use std::fmt;

use lashloop_bench::scenario::Scenario;
use serde::{Deserialize, Serialize};

use super::law::Law;

/// A part of the battery: a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Part {
    /// Plants nobody tuned a controller for.
    RandomPlants,
    /// The nominal plant with another gap.
    DeadZone,
    /// The nominal plant behind other encoders.
    EncoderCounts,
    /// The nominal plant with another limit of the drive's torque.
    TorqueLimit,
    /// The nominal plant with another delay of the torque.
    TorqueDelay,
}

impl Part {
    /// The name in records.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::RandomPlants => "random-plants",
            Self::DeadZone => "dead-zone",
            Self::EncoderCounts => "encoder-counts",
            Self::TorqueLimit => "torque-limit",
            Self::TorqueDelay => "torque-delay",
        }
    }
}

/// Where a run belongs: the table, its row from 0, and the law.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CaseId {
    /// The table.
    pub part: Part,
    /// The number of the plant or of the value.
    pub row: u32,
    /// The law.
    pub law: Law,
}

/// One run to be made.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// Where it belongs.
    pub id: CaseId,
    /// What is other than in the law's scenario, as `--set` takes it.
    pub settings: Vec<String>,
    /// The run.
    pub scenario: Scenario,
}

impl fmt::Display for CaseId {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { part, row, law } = self;
        write!(out, "{law} in row {row} of {}", part.name())
    }
}
