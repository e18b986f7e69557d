//! The options of a drive, bench mode and boot loader, as far as they show without hardware: what is refused, and in which order.
//!
//! No check starts a run in bench mode, or the boot loader of a drive that has one.

use crate::prelude::checks::*;

/// The parameters of bench mode after the first, with their types and units.
const PARAMETERS: [(&str, ParameterType, &str); 9] = [
    ("bench_sample_every", ParameterType::U32, ""),
    ("motor_direction", ParameterType::U32, ""),
    ("load_direction", ParameterType::U32, ""),
    ("torque_direction", ParameterType::U32, ""),
    ("torque_per_duty_nm", ParameterType::F32, "N m"),
    ("duty_offset", ParameterType::F32, ""),
    ("duty_min", ParameterType::F32, ""),
    ("duty_max", ParameterType::F32, ""),
    ("twist_limit_rad", ParameterType::F32, "rad"),
];
/// Choices of `sample_source`, and those of a direction, from 0.
const SOURCES: [&str; 2] = ["link", "pins"];
const DIRECTIONS: [&str; 2] = ["forward", "reverse"];
pub(super) const PINS: ParameterValue = U32(1);
/// Least and largest details of the refusals by the hardware.
const DETAILS: [(Outcome, [u32; 2]); 2] = [(PowerStageFault, [1, 7]), (EncoderImplausible, [1, 5])];
/// The encoders were not read since power-up.
pub(super) const UNREAD: u32 = 1;

pub(super) fn checks() -> Vec<Check> {
    vec![
        check("R18.2", "a drive has the parameters of bench mode if it announces it", parameters),
        check("R4.16 R18.3 R18.9", "a Reference is refused in every state of HIL mode", reference),
        check("R18.4", "Arm in bench mode checks session, state and parameters before the pins", arming),
        check("R18.4", "no limit of the duty is short of torque_limit_nm in either direction", duties),
        check("R19.1 R19.2", "EnterLoader is refused in another session and in every state but Idle", loader),
    ]
}

pub(super) fn has(client: &Client, capability: Capabilities) -> bool {
    client.identity.capabilities.contains(capability)
}

fn parameters(client: &mut Client) -> RuleResult {
    let is_offered = client.description.parameters.iter().any(|it| it.name == SAMPLE_SOURCE);
    let is_announced = has(client, Capabilities::BENCH_MODE);
    equal("whether bench mode is offered, by the capabilities:", is_announced, is_offered)?;
    if !is_offered {
        return Ok(());
    }
    let it = client.parameter(SAMPLE_SOURCE)?;
    equal(&format!("default of {SAMPLE_SOURCE}"), U32(0), it.default)?;
    let directions = ["motor_direction", "load_direction", "torque_direction"].map(|it| (it, DIRECTIONS));
    for (name, wanted) in [(SAMPLE_SOURCE, SOURCES)].into_iter().chain(directions) {
        let choices = &client.parameter(name)?.choices;
        let choices: Vec<_> = choices.iter().map(|choice| choice.name.as_str()).collect();
        equal(&format!("choices of {name}"), wanted.to_vec(), choices)?;
    }
    for (name, ty, unit) in PARAMETERS.into_iter().chain([(SAMPLE_SOURCE, ParameterType::U32, "")]) {
        let it = client.parameter(name)?;
        let is_of_all = it.laws.is_all(&client.description.laws);
        let got = (it.default.ty(), it.unit.as_str(), it.live, is_of_all);
        let what = format!("{name}: type, unit, whether live, whether of all laws");
        equal(&what, (ty, unit, false, true), got)?;
    }
    Ok(())
}

/// A drive without bench mode may not know the message, and gives no answer.
fn reference(client: &mut Client) -> RuleResult {
    client.in_states(State::ALL, |client, state| {
        if state == Running {
            first_sample(client)?;
        }
        for (number, reference_rad) in [(0, 1.0), (u16::MAX, f32::NAN)] {
            refuses_reference(client, Reference { number, reference_rad }, state)?;
        }
        if state == Running {
            accepted(client, sample(1), NONE)?;
        }
        Ok(())
    })
}

pub(super) fn refuses_reference(client: &mut Client, reference: Reference, state: State) -> RuleResult {
    let answers = client.request(reference)?;
    if answers.is_empty() && !has(client, Capabilities::BENCH_MODE) {
        return equal("state after a Reference", state, client.state);
    }
    let (request, outcome) = (Reference::LAYOUT.kind, WrongState);
    let wanted = CommandResult { request, outcome, state, detail: 0, device_time_us: None };
    equal(&format!("in {state}, to a Reference"), vec![DriveMessage::from(wanted)], answers)
}

/// A parameter, and its value by its range.
type Setting = (&'static str, fn(&Parameter) -> ParameterValue);

/// Puts bench mode and two of its parameters in place.
fn bench(client: &mut Client, duties: [Setting; 2]) -> RuleResult {
    client.idle()?;
    client.put(SAMPLE_SOURCE, PINS)?;
    for (name, value) in duties {
        let value = value(client.parameter(name)?);
        client.put(name, value)?;
    }
    Ok(())
}

fn arming(client: &mut Client) -> RuleResult {
    if !has(client, Capabilities::BENCH_MODE) {
        return skip("the drive has no bench mode");
    }
    let session = client.session;
    // No duty of no torque is both.
    bench(client, [("duty_min", |it| it.max), ("duty_offset", |it| it.min)])?;
    client.exchange("in bench mode", &[result(Arm { session: session ^ 1 }, WrongSession, Idle)])?;
    let it = arm(client)?;
    equal("Arm with a duty_min above duty_offset", Inconsistent, it.outcome)?;
    names_cause(client, it, &["duty_min", "duty_offset", "duty_max"])?;
    // What was refused leaves nothing behind.
    bench(client, [("duty_min", |it| it.default), ("duty_offset", |it| it.default)])?;
    bench(client, [("duty_max", |it| it.default), ("torque_per_duty_nm", |it| it.max)])?;
    let it = arm(client)?;
    expect(it.outcome != Inconsistent, "Arm with the default duties after a refusal", it)?;
    client.reset()?;
    bench(client, [("duty_min", |it| it.max), ("duty_offset", |it| it.min)])?;
    // They count in bench mode only.
    client.put(SAMPLE_SOURCE, U32(0))?;
    client.exchange("in HIL mode", &[result(Arm { session }, Accepted, Armed)])?;
    client.reset()?;
    bench(client, [("duty_max", |it| it.min), ("duty_offset", |it| it.max)])?;
    let it = arm(client)?;
    equal("Arm with a duty_max below duty_offset", Inconsistent, it.outcome)?;
    names_cause(client, it, &["duty_min", "duty_offset", "duty_max"])?;
    client.reset()?;
    // Equal ones have a duty of no torque.
    let offset = client.parameter("duty_offset")?.default;
    let no_torque_nm = nearest_real(client.parameter(TORQUE_LIMIT_NM)?, 0.0)?;
    client.idle()?;
    client.put_all(&[
        (SAMPLE_SOURCE, PINS),
        (TORQUE_LIMIT_NM, F32(no_torque_nm)),
        ("duty_min", offset),
        ("duty_max", offset),
    ])?;
    let it = arm(client)?;
    expect(it.outcome != Inconsistent, "Arm with a duty of no torque alone", it)?;
    client.reset()?;
    client.exchange("after Reset", &[result(Arm { session }, WrongSession, Boot)])?;
    bench(client, [("torque_per_duty_nm", |it| it.max), ("duty_min", |it| it.default)])?;
    if arm(client)?.outcome == Accepted {
        let stale = result(Start { session: session ^ 1 }, WrongSession, Armed);
        client.exchange("in bench mode", &[result(Arm { session }, WrongState, Armed), stale])?;
        no_torque(client, 0, Armed)?;
        refuses_reference(client, Reference { number: 0, reference_rad: 0.0 }, Armed)?;
        client.request(Stop {})?;
    }
    no_torque(client, 1, Idle)?;
    refuses_reference(client, Reference { number: 1, reference_rad: 0.0 }, Idle)
}

/// Requires the index of one of these parameters as the detail of a refusal.
fn names_cause(client: &Client, it: CommandResult, causes: &[&str]) -> RuleResult {
    let cause = client.description.parameters.iter().find(|cause| u32::from(cause.index) == it.detail);
    let is_cause = cause.is_some_and(|cause| causes.contains(&cause.name.as_str()));
    expect(is_cause, format!("the index of {} as its detail", causes.join(" or ")), it)
}

/// Bench mode with a duty for as many torques as possible.
pub(super) fn widest_duties(client: &mut Client) -> RuleResult {
    let [least, most] = [client.parameter("duty_min")?.min, client.parameter("duty_max")?.max];
    let scale = client.parameter("torque_per_duty_nm")?.max;
    client.put_all(&[
        (SAMPLE_SOURCE, PINS),
        ("torque_per_duty_nm", scale),
        ("duty_min", least),
        ("duty_max", most),
    ])
}

/// The duty of the largest torque at a limit of the duty, within it, and beyond it by a fraction of the torque.
fn duties(client: &mut Client) -> RuleResult {
    if !has(client, Capabilities::BENCH_MODE) {
        return skip("the drive has no bench mode");
    }
    let limit_nm = nearest_real(client.parameter(TORQUE_LIMIT_NM)?, 1.0)?;
    let scale_nm = nearest_real(client.parameter("torque_per_duty_nm")?, 4.0 * limit_nm)?;
    let offset = client.parameter("duty_offset")?.default;
    let F32(center) = offset else { return Ok(()) };
    let width = limit_nm / scale_nm;
    let scale = [(TORQUE_LIMIT_NM, F32(limit_nm)), ("torque_per_duty_nm", F32(scale_nm))];
    client.idle()?;
    widest_duties(client)?;
    client.put_all(&scale)?;
    if arm(client)?.outcome == Inconsistent {
        return skip("not run: the drive refuses its pins with its widest duties");
    }
    for (name, outwards) in [("duty_min", -width), ("duty_max", width)] {
        for (fraction, is_consistent) in [(1.001, true), (1.0, true), (0.999, false), (0.5, false)] {
            let duty = F32(center + outwards * fraction);
            if !holds(client.parameter(name)?, duty) {
                return skip("not run: the ranges of the duty exclude a setting of this check");
            }
            client.reset()?;
            client.idle()?;
            widest_duties(client)?;
            client.put_all(&scale)?;
            client.put(name, duty)?;
            let it = arm(client)?;
            let what =
                format!("Arm with a duty of {} of that of the largest torque in {name}", fraction.words());
            expect((it.outcome == Inconsistent) != is_consistent, what, it)?;
            if it.outcome == Inconsistent {
                let causes = ["duty_min", "duty_offset", "duty_max", TORQUE_LIMIT_NM, "torque_per_duty_nm"];
                names_cause(client, it, &causes)?;
            }
        }
    }
    Ok(())
}

/// Arms, and requires an outcome of the page with its detail.
pub(super) fn arm(client: &mut Client) -> Result<CommandResult, Failure> {
    let session = client.session;
    let what = "answers to Arm in bench mode";
    let answers = of_kinds(what, &["CommandResult"], client.request(Arm { session })?)?;
    let it = command_result(&Arm::LAYOUT, &answers)?;
    let [least, most] = match it.outcome {
        Accepted => [0, 0],
        Inconsistent => [0, u32::from(client.identity.parameter_count.saturating_sub(1))],
        outcome => {
            let details = DETAILS.into_iter().find(|(of, _)| *of == outcome).map(|(_, details)| details);
            details.ok_or_else(|| broken("to Arm in bench mode an outcome of the page", it.words()))?
        }
    };
    expect((least..=most).contains(&it.detail), format!("a detail of {least} to {most}"), it)?;
    let is_unread = (it.outcome, it.detail) == (EncoderImplausible, UNREAD);
    expect(
        !is_unread || !client.has_read_encoders,
        "an Arm that still has the readings of an earlier one",
        it,
    )?;
    client.has_read_encoders |= !is_unread && matches!(it.outcome, Accepted | EncoderImplausible);
    let state = if it.outcome == Accepted { Armed } else { Idle };
    equal("state after Arm in bench mode", (state, state), (it.state, client.state))?;
    Ok(it)
}

fn loader(client: &mut Client) -> RuleResult {
    let session = client.session;
    client.in_states(State::ALL, |client, state| {
        let when = format!("in {state}");
        if has(client, Capabilities::LOADER) {
            client.exchange(&when, &[result(EnterLoader { session: session ^ 1 }, WrongSession, state)])?;
            let outcome = if state == Boot { WrongSession } else { WrongState };
            if state != Idle {
                client.exchange(&when, &[result(EnterLoader { session }, outcome, state)])?;
            }
            return Ok(());
        }
        for session in [session ^ 1, session] {
            let what = format!("{when}, answers to EnterLoader");
            let answers = of_kinds(&what, &["CommandResult"], client.request(EnterLoader { session })?)?;
            let it = command_result(&EnterLoader::LAYOUT, &answers)?;
            let is_refused = matches!(it.outcome, WrongState | UnknownRequest);
            let expected =
                format!("{when}, from a drive without a boot loader, WrongState or UnknownRequest");
            expect(is_refused && (it.state, it.detail) == (state, 0), expected, it)?;
        }
        equal(&format!("{when}, state afterwards"), state, client.state)
    })
}
