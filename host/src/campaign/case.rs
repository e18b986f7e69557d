//! One run of a campaign, its position in the tables and its result.

use std::fmt;

use lashloop_bench::scenario::Scenario;
use serde::{Deserialize, Serialize};

use super::law::Law;
use super::score::Scores;

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
    /// The nominal plant, inertia of the load varied.
    LoadInertia,
    /// The nominal plant, lasting torque on the load varied.
    LoadTorque,
    /// The nominal plant, saturation of the motor varied, which is not set in the drive.
    TorqueSaturation,
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

/// The result of one run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CaseResult {
    pub case: CaseId,
    pub end: String,
    pub scores: Scores,
    /// Digest of the torque stream, see [`TorqueDigest`](lashloop_bench::run::digest::TorqueDigest).
    pub torque_sha256: String,
}
