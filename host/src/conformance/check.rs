//! One rule of the protocol, and how a drive can break it.

use std::sync::Arc;

use super::assertion::RuleResult;
use super::client::Client;

/// A rule and the code that tries it.
#[derive(Clone)]
pub(super) struct Check {
    pub(super) group: &'static str,
    pub(super) name: String,
    /// Whether device time has to pass for it.
    pub(super) waits: bool,
    pub(super) run: Arc<dyn Fn(&mut Client) -> RuleResult>,
}

impl Check {
    pub(super) fn new(
        group: &'static str,
        name: impl Into<String>,
        run: impl Fn(&mut Client) -> RuleResult + 'static,
    ) -> Self {
        Self { group, name: name.into(), waits: false, run: Arc::new(run) }
    }

    /// The same check, marked as one for which device time has to pass.
    pub(super) fn waiting(self) -> Self {
        Self { waits: true, ..self }
    }
}
