//! One rule of the protocol and the code that checks it.

use super::assertion::RuleResult;
use super::client::Client;

pub(super) struct Check {
    pub(super) name: String,
    pub(super) run: Box<dyn Fn(&mut Client) -> RuleResult>,
}

pub(super) fn check(name: impl Into<String>, run: impl Fn(&mut Client) -> RuleResult + 'static) -> Check {
    Check { name: name.into(), run: Box::new(run) }
}
