//! Whether a value that a drive accepted has an effect.

use super::super::range::within;
use super::super::samples::runs::{equal_torques, torques_of_a_run};
use super::values::set_live;
use crate::prelude::checks::*;

/// Samples of a run that shows the effect of a live parameter.
const STEPS: u16 = 14;
/// Live parameters that are tried, fewer on a slow line.
const MOST_LIVE: usize = 8;
/// Last sample before a setting in `Running`, and the first one after it.
const BEFORE: u16 = 10;
const AFTER: u16 = BEFORE + 1;

pub(super) fn checks() -> Vec<Check> {
    vec![
        check("R7.17 R9.11", "a law uses its own parameters only", of_other_laws),
        check(
            "R9.5",
            "a live parameter set before the first sample has the effect of one set in Idle",
            live_in_armed,
        ),
        check(
            "R7.3 R7.17 R9.5",
            "a live parameter set in Running has an effect from the next sample",
            live_in_running,
        ),
    ]
}

/// When a run gets the value of the parameter under test.
#[derive(Clone, Copy, PartialEq)]
enum Set {
    Never,
    InIdle,
    InArmed,
    /// In `Running`, before the first sample.
    AtFirst,
    InRunning,
    /// As [`Self::InRunning`], and back to the default one sample later.
    AndBack,
}

/// Sample from which both encoders move by a count each, which is never a jump.
const MOVING: u16 = 2;

/// Torques of a run, as bits, and the value of the parameter after its `Stop`; `None` if the value contradicts the others.
type Run = Option<(Vec<u32>, ParameterValue)>;

fn run(client: &mut Client, it: &Parameter, value: ParameterValue, when: Set) -> Result<Run, Failure> {
    client.reset()?;
    client.idle()?;
    client.long_watchdog()?;
    let law =
        client.description.laws.iter().find(|law| it.laws.contains(law.index)).map_or(0, |law| law.index);
    if it.name != CONTROLLER {
        client.put_law(law)?;
    }
    // A limited torque would hide an effect.
    let limit = client.parameter(TORQUE_LIMIT_NM)?.max;
    client.put(TORQUE_LIMIT_NM, limit)?;
    if when == Set::InIdle {
        client.put(&it.name, value)?;
    }
    let session = client.session;
    let answers = client.request(Arm { session })?;
    if outcome::<Arm>(&answers)? == Inconsistent
        || when == Set::InArmed && set_live(client, it, value)? != value
    {
        return Ok(None);
    }
    client.start()?;
    if when == Set::AtFirst && set_live(client, it, value)? != value {
        return Ok(None);
    }
    let mut torques = Vec::new();
    for sequence in 0..STEPS {
        let reference_rad = 0.5 + 0.125 * f32::from(sequence);
        let counts = EncoderCounts::wrapping(sequence.saturating_sub(MOVING - 1).into());
        let sample = EncoderSample { sequence, motor_counts: counts, load_counts: counts, reference_rad };
        let answers = client.request_to(sample, TorqueAnswer::LAYOUT.name)?;
        let answer = torque(&answers)?;
        // With some values a law may request more than is finite.
        if answer.status.state == Faulted {
            return Ok(None);
        }
        let torque_nm = answer.torque_nm;
        torques.push(torque_nm.to_bits());
        let new = match (when, sequence) {
            (Set::InRunning | Set::AndBack, BEFORE) => value,
            (Set::AndBack, AFTER) => it.default,
            _ => continue,
        };
        if set_live(client, it, new)? != new {
            return Ok(None);
        }
        let again = torque(&client.request_to(sample, TorqueAnswer::LAYOUT.name)?)?.torque_nm;
        let what = format!("torque in N m of the repeated sample after {} was set", it.name);
        equal(&what, torque_nm.words(), again.words())?;
    }
    client.request(Stop {})?;
    Ok(Some((torques, client.get(it.index)?.value)))
}

/// The live parameters that may be changed at will, each with another value.
fn live(client: &Client) -> Result<Vec<(Parameter, ParameterValue)>, Failure> {
    let live = client.description.parameters.iter().filter(|it| it.live);
    let with_value = live.map(|it| (it.clone(), another(it)));
    let found: Vec<_> = with_value.take(client.repetitions(MOST_LIVE)).collect();
    if found.is_empty() { skip("the drive has no live parameter") } else { Ok(found) }
}

/// A quarter more than the default, so that no torque is far from those of the default; else the middle of the range, or the
/// value next to the default.
pub(in super::super) fn another(it: &Parameter) -> ParameterValue {
    let more = match it.default {
        F32(default) => F32(1.25 * default),
        other => other,
    };
    let mut candidates = [more, within(it, 0.5)].into_iter();
    let other = candidates.find(|value| holds(it, *value) && *value != it.default);
    other.unwrap_or_else(|| neighbour(it))
}

/// Each law, with other values of all parameters that it lacks.
fn of_other_laws(client: &mut Client) -> RuleResult {
    let (laws, parameters) = (client.description.laws.clone(), client.description.parameters.clone());
    let mut has_some = false;
    for law in laws {
        let lacking = parameters.iter().filter(|it| !it.laws.contains(law.index));
        let settings: Vec<_> = lacking.map(|it| (it.name.to_string(), another(it))).collect();
        has_some |= !settings.is_empty();
        client.reset()?;
        client.long_watchdog()?;
        client.put_law(law.index)?;
        let first = torques_of_a_run(client, |_, _| Ok(()))?;
        client.command(Stop {})?;
        for (name, value) in &settings {
            client.put(name, *value)?;
        }
        let again = torques_of_a_run(client, |_, _| Ok(()))?;
        let what = format!("{} with other values of the parameters that it lacks", law.name);
        equal_torques(&what, &first, &again)?;
    }
    if has_some { Ok(()) } else { skip("every law has every parameter") }
}

fn live_in_armed(client: &mut Client) -> RuleResult {
    for (it, value) in live(client)? {
        let Some((wanted, _)) = run(client, &it, value, Set::InIdle)? else { continue };
        for (when, words) in [(Set::InArmed, "in Armed"), (Set::AtFirst, "in Running before sample 0")] {
            let Some((got, kept)) = run(client, &it, value, when)? else { continue };
            let what = format!("{} = {value} set {words}:", it.name);
            equal(&format!("{what} torques, as bits, as if set in Idle,"), wanted.clone(), got)?;
            equal(&format!("{what} value after Stop"), value, kept)?;
        }
    }
    Ok(())
}

fn live_in_running(client: &mut Client) -> RuleResult {
    for (it, value) in live(client)? {
        let runs = [Set::Never, Set::InIdle, Set::InRunning, Set::AndBack];
        let [never, first, later, back] = runs.map(|when| run(client, &it, value, when));
        let (Some((never, _)), Some((first, _)), Some((later, kept)), Some((back, restored))) =
            (never?, first?, later?, back?)
        else {
            continue;
        };
        let next = usize::from(AFTER);
        let name = &it.name;
        let what = format!("torques before {name} was set, as bits,");
        equal(&what, never[..next].to_vec(), later[..next].to_vec())?;
        let what = format!("{name} = {value} set in Running, and then its default: values after Stop");
        equal(&what, (value, it.default), (kept, restored))?;
        let Some((same, _)) = run(client, &it, it.default, Set::InRunning)? else { continue };
        equal(
            &format!("torques of a run in which {name} is set to its own value, as bits,"),
            never.clone(),
            same,
        )?;
        // A value with an effect on the first torque, or on the first one of a motion, has it from the next sample on.
        let moving = usize::from(MOVING);
        let acts_at_once = (0..=moving).find(|step| first[*step] != never[*step]);
        if acts_at_once.is_some_and(|step| step == 0 || step == moving) && first[next] != never[next] {
            let expected = format!("another torque at the sample after {name} = {value} was set in Running");
            expect(later[next] != never[next], expected, "that of the value before")?;
            if later[next + 1] != never[next + 1] {
                let expected =
                    format!("another torque at the sample after {name} was set to its default again");
                expect(back[next + 1] != later[next + 1], expected, "that of the value before")?;
            }
        }
    }
    Ok(())
}
