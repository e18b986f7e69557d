//! The result of one run.

use serde::{Deserialize, Serialize};

use super::case::CaseId;
use super::score::Scores;

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CaseResult {
    pub case: CaseId,
    pub end: String,
    pub scores: Scores,
    /// Digest of the torque stream, see [`TorqueDigest`](lashloop_bench::record::digest::TorqueDigest).
    pub torque_sha256: String,
}
