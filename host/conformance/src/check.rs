//! One rule of the protocol and the code that checks it.

use super::assertion::RuleResult;
use super::client::Client;

pub(super) struct Check {
    /// Numbers of the page's rules under test, separated by spaces.
    pub(super) rules: &'static str,
    /// The rule, as a sentence.
    pub(super) name: String,
    pub(super) run: Box<dyn Fn(&mut Client) -> RuleResult>,
}

pub(super) fn check(
    rules: &'static str,
    name: impl Into<String>,
    run: impl Fn(&mut Client) -> RuleResult + 'static,
) -> Check {
    Check { rules, name: name.into(), run: Box::new(run) }
}
