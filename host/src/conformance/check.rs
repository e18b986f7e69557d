//! One rule of the protocol and the code that checks it.

use std::sync::Arc;

use super::assertion::RuleResult;
use super::client::Client;

#[derive(Clone)]
pub(super) struct Check {
    pub(super) group: &'static str,
    pub(super) name: String,
    pub(super) run: Arc<dyn Fn(&mut Client) -> RuleResult>,
}

impl Check {
    pub(super) fn new(
        group: &'static str,
        name: impl Into<String>,
        run: impl Fn(&mut Client) -> RuleResult + 'static,
    ) -> Self {
        Self { group, name: name.into(), run: Arc::new(run) }
    }
}
