//! What ends a campaign early.

use lashloop_bench::run::RunError;

use super::case::CaseId;
use crate::journal::JournalError;

#[derive(Debug, thiserror::Error)]
pub enum CampaignError {
    #[error("{case}: {source}")]
    Run { case: CaseId, source: Box<RunError> },
    #[error(transparent)]
    Journal(#[from] JournalError),
}
