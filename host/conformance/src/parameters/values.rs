//! All parameters of a drive, one by one, and their values.

use crate::prelude::checks::*;

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

/// Sets all parameters to these values, in the order of their indices.
pub(crate) fn set_all(client: &mut Client, values: &[ParameterValue], descending: bool) -> RuleResult {
    let each = (0..).zip(values).map(|(index, value)| sets(index, *value, Accepted, *value, Idle));
    let mut each: Vec<Exchange> = each.collect();
    if descending {
        each.reverse();
    }
    client.exchange("in Idle", &each)
}

/// Sets a live parameter in `Armed` or `Running`. Returns the value in force: the drive may refuse one that contradicts the others.
pub(crate) fn set_live(
    client: &mut Client,
    it: &Parameter,
    value: ParameterValue,
) -> Result<ParameterValue, Failure> {
    let before = client.get(it.index)?.value;
    let report = client.set(it.index, value)?;
    let got = (report.outcome, report.value);
    if report.outcome != Inconsistent {
        let what = format!("{} = {value} in {}: outcome, value and detail", it.name, client.state);
        equal(&what, (Accepted, value, 0), (got.0, got.1, report.detail))?;
        return Ok(value);
    }
    let what = format!("{} = {value} refused in {}: value and detail", it.name, client.state);
    equal(&what, before, got.1)?;
    let is_index = report.detail < u32::from(client.identity.parameter_count);
    expect(is_index, format!("{what} that is an index"), report.detail)?;
    Ok(before)
}

pub(crate) fn defaults(client: &Client) -> Vec<ParameterValue> {
    client.description.parameters.iter().map(|it| it.default).collect()
}
