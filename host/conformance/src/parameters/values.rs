//! All parameters of a drive, one by one, and their values.

use lashloop_protocol::enums::{ParameterValue, State};

use lashloop_session::Parameter;

use super::super::assertion::RuleResult;
use super::super::burst::{Exchange, reads};
use super::super::client::Client;

pub(super) fn each(
    client: &mut Client,
    mut check: impl FnMut(&mut Client, &Parameter) -> RuleResult,
) -> RuleResult {
    client.description.parameters.to_vec().iter().try_for_each(|parameter| check(client, parameter))
}

/// Requires these values in force, in the order of the indices.
pub(crate) fn in_force(
    client: &mut Client,
    when: &str,
    values: &[ParameterValue],
    state: State,
) -> RuleResult {
    let all: Vec<Exchange> = (0..).zip(values).map(|(index, value)| reads(index, *value, state)).collect();
    client.exchange(when, &all)
}

pub(crate) fn defaults(client: &Client) -> Vec<ParameterValue> {
    client.description.parameters.iter().map(|it| it.default).collect()
}
