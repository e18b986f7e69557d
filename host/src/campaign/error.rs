//! What ends a campaign early.

use lashloop_bench::run::RunError;

use super::case::CaseId;
use super::journal::JournalError;

#[derive(Debug, thiserror::Error)]
pub enum CampaignError {
    /// A run could not be made.
    #[error("{case}: {source}")]
    Run {
        /// Which.
        case: CaseId,
        /// Why.
        source: Box<RunError>,
    },
    /// A result could not be kept.
    #[error(transparent)]
    Journal(#[from] JournalError),
}
