//! Whether a value that a drive accepted has an effect.

use lashloop_protocol::enums::{Outcome, ParameterValue};
use lashloop_protocol::message::{Arm, EncoderSample, Stop, TorqueAnswer};
use lashloop_protocol::parameter_names::CONTROLLER;
use lashloop_protocol::wire::Payload;

use lashloop_session::Parameter;

use super::super::answers::{outcome, sample, torque};
use super::super::assertion::{Failure, RuleResult, equal, expect, skip};
use super::super::check::{Check, check};
use super::super::client::Client;
use super::super::range::{neighbour, within};
use super::values::set_live;

/// Samples of a run that shows the effect of a live parameter.
const STEPS: u16 = 14;
/// Live parameters that are tried, fewer on a slow line.
const MOST_LIVE: usize = 8;
/// Last sample before a setting in `Running`.
const BEFORE: u16 = 10;

pub(super) fn checks() -> Vec<Check> {
    vec![
        check("R9.5", "a live parameter set in Armed has the effect of one set in Idle", live_in_armed),
        check("R9.5", "a live parameter set in Running has an effect from the next sample", live_in_running),
    ]
}

/// When a run gets the value of the parameter under test.
#[derive(Clone, Copy, PartialEq)]
enum Set {
    Never,
    InIdle,
    InArmed,
    InRunning,
}

/// Torques of a run, as bits, and the value of the parameter after its `Stop`; `None` if the value contradicts the others.
type Run = Option<(Vec<u32>, ParameterValue)>;

fn run(client: &mut Client, it: &Parameter, value: ParameterValue, when: Set) -> Result<Run, Failure> {
    client.reset()?;
    client.idle()?;
    client.long_watchdog()?;
    let law =
        client.description.laws.iter().find(|law| it.laws.contains(law.index)).map_or(0, |law| law.index);
    if it.name != CONTROLLER && client.parameter(CONTROLLER).is_ok() {
        client.put(CONTROLLER, ParameterValue::U32(law.into()))?;
    }
    if when == Set::InIdle {
        client.put(&it.name, value)?;
    }
    let session = client.session;
    let answers = client.request(Arm { session })?;
    if outcome::<Arm>(&answers)? == Outcome::Inconsistent
        || when == Set::InArmed && set_live(client, it, value)? != value
    {
        return Ok(None);
    }
    client.start()?;
    let mut torques = Vec::new();
    for sequence in 0..STEPS {
        let reference_rad = 0.5 + 0.125 * f32::from(sequence);
        let sample = EncoderSample { reference_rad, ..sample(sequence) };
        let answers = client.request_to(sample, TorqueAnswer::LAYOUT.name)?;
        torques.push(torque(&answers)?.torque_nm.to_bits());
        if when == Set::InRunning && sequence == BEFORE && set_live(client, it, value)? != value {
            return Ok(None);
        }
    }
    client.request(Stop {})?;
    Ok(Some((torques, client.get(it.index)?.value)))
}

/// The live parameters that may be changed at will, each with another value.
fn live(client: &Client) -> Result<Vec<(Parameter, ParameterValue)>, Failure> {
    let live = client.description.parameters.iter().filter(|it| it.live);
    let with_value = live.map(|it| {
        let middle = within(it, 0.5);
        (it.clone(), if middle == it.default { neighbour(it) } else { middle })
    });
    let found: Vec<_> = with_value.take(client.repetitions(MOST_LIVE)).collect();
    if found.is_empty() { skip("the drive has no live parameter") } else { Ok(found) }
}

fn live_in_armed(client: &mut Client) -> RuleResult {
    for (it, value) in live(client)? {
        let Some((wanted, _)) = run(client, &it, value, Set::InIdle)? else { continue };
        let Some((got, kept)) = run(client, &it, value, Set::InArmed)? else { continue };
        let what = format!("{} = {value} set in Armed:", it.name);
        equal(&format!("{what} torques, as bits, as if set in Idle,"), wanted, got)?;
        equal(&format!("{what} value after Stop"), value, kept)?;
    }
    Ok(())
}

fn live_in_running(client: &mut Client) -> RuleResult {
    for (it, value) in live(client)? {
        let runs = [Set::Never, Set::InIdle, Set::InRunning].map(|when| run(client, &it, value, when));
        let [never, first, later] = runs;
        let (Some((never, _)), Some((first, _)), Some((later, kept))) = (never?, first?, later?) else {
            continue;
        };
        let next = usize::from(BEFORE) + 1;
        let name = &it.name;
        let what = format!("torques before {name} was set, as bits,");
        equal(&what, never[..next].to_vec(), later[..next].to_vec())?;
        equal(&format!("{name} = {value} set in Running: value after Stop"), value, kept)?;
        // A value with an effect on the first torque and on this one has it from the next sample on.
        if first[0] != never[0] && first[next] != never[next] {
            let expected = format!("another torque at the sample after {name} = {value} was set in Running");
            expect(later[next] != never[next], expected, "that of the value before")?;
        }
    }
    Ok(())
}
