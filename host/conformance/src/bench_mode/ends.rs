//! What keeps a run alive, what ends it, and the run after it.

use super::super::growth::has_names;
use super::super::pins::{self, PINS};
use super::super::safety::{FEEDS, in_time, nearly_in_time};
use super::run::{Run, allowed, in_turn};
use crate::prelude::checks::*;

/// Steps that a drive makes while a request is on its way.
const LATEST_STEPS: u16 = 500;
/// Reports that a drive may omit at the end of a run.
const MOST_OMITTED: u16 = 5;
/// The drive must latch the fault this long after the limit, in s.
const LATEST_S: f32 = 0.11;
/// Timeout for a watchdog that must trip.
const PATIENCE: Duration = Duration::from_secs(1);

pub(super) fn checks() -> Vec<Check> {
    vec![
        allowed("R18.9", "an EncoderSample is refused, and the run continues", refused_sample),
        in_time(allowed(
            "R8.5 R18.10 R18.11",
            "a Reference, and nothing else, restarts the watchdog",
            watchdog,
        )),
        nearly_in_time(allowed(
            "R8.4 R8.6 R18.10",
            "no other frame restarts the watchdog, and its report has the last step",
            feeds,
        )),
        allowed("R18.5 R18.9", "no step follows Stop, a fault, a new session or Reset", ends),
        allowed("R18.2 R18.9", "the value of sample_source at Arm selects the mode of each run", modes),
    ]
}

fn refused_sample(client: &mut Client) -> RuleResult {
    let mut run = Run::start(client, &[])?;
    let mut reports = run.reports(3, 0.5)?;
    // Each would be a fault in HIL mode.
    let far = EncoderCounts::MAX;
    for (sequence, reference_rad) in [(0, f32::NAN), (reports.len() as u16, 0.0), (0x7123, 0.0)] {
        let sample = EncoderSample { sequence, motor_counts: far, load_counts: far, reference_rad };
        let answers = run.client.request(sample)?;
        reports.extend(answers.iter().filter_map(of::<BenchSample>));
        let answers = answers.into_iter().filter(|it| !is::<BenchSample>(it)).collect();
        let answers = of_kinds("to an EncoderSample in bench mode", &["CommandResult"], answers)?;
        let got = (outcome::<EncoderSample>(&answers)?, run.client.state);
        equal("outcome and state", (WrongState, Running), got)?;
        reports.extend(run.reports(3, 0.5)?);
    }
    // No step more, and none less.
    let timing = run.timing();
    in_turn(&reports, timing.every)?;
    let last = reports.last().map_or(0, |it| it.sequence);
    let it = fault(&run.client.request(EmergencyStop {})?)?;
    let is_later = it.sequence.wrapping_sub(last) <= LATEST_STEPS;
    expect(is_later, format!("a step soon after {last}"), it)?;
    // Of a run without a step, after one with some.
    client.reset()?;
    let mut run = Run::start_at(client, timing, &[])?;
    run.reports(3, 0.5)?;
    run.client.request(Stop {})?;
    let it = fault(&Run::again(run.client, timing)?.client.request(EmergencyStop {})?)?;
    equal("step of a fault before the first Reference", 0, it.sequence)
}

/// What feeds no watchdog in HIL mode doesn't here, and no sample does.
fn feeds(client: &mut Client) -> RuleResult {
    let watchdog_us = nearest_whole(client.parameter(WATCHDOG_US)?, 60_000)?;
    // Among the requests, and the only one that does.
    let reference = HostMessage::from(Reference { number: 0, reference_rad: 0.0 }).frame();
    for (_, what, feed) in FEEDS {
        client.reset()?;
        let mut run = Run::start(client, &[(WATCHDOG_US, U32(watchdog_us))])?;
        let (mut messages, mut last) = (run.refer(0.5)?, 0);
        let begun = Moment::latest(run.client);
        for count in 0.. {
            last = messages.iter().filter_map(of::<BenchSample>).next_back().map_or(last, |it| it.sequence);
            if let Some(it) = messages.iter().find_map(of::<FaultReport>) {
                let step = (run.timing().every == 1).then_some(last);
                judge_trip(Some(it), watchdog_us, step)?;
                break;
            }
            let silence = begun.elapsed(run.client);
            expect(silence < PATIENCE, format!("{what}: a FaultReport"), "none")?;
            let bytes = feed(run.client, count);
            messages = run.client.request_bytes(bytes.strip_suffix(&*reference).unwrap_or(&bytes))?;
            messages.extend(run.turn()?);
        }
    }
    Ok(())
}

/// Until the watchdog's report, or for some time by the drive's clock.
fn fault_within(run: &mut Run<'_>, time: Duration, keep_alive: bool) -> Result<Option<FaultReport>, Failure> {
    let begun = Moment::latest(run.client);
    while begun.elapsed(run.client) < time {
        // Its number and value may be those of the last one.
        let mut messages = if keep_alive { run.refer_again(0.5)? } else { run.client.request_bytes(&[])? };
        messages.extend(run.turn()?);
        let found = messages.iter().find_map(of::<FaultReport>);
        if found.is_some() {
            return Ok(found);
        }
    }
    Ok(None)
}

fn watchdog(client: &mut Client) -> RuleResult {
    // Long enough that one that takes twice its time is too late.
    let watchdog_us = nearest_whole(client.parameter(WATCHDOG_US)?, 300_000)?;
    let watchdog = Duration::from_micros(watchdog_us.into());
    let settings = [(WATCHDOG_US, U32(watchdog_us))];
    // From the start on, before any reference, and in time, not in periods.
    let period_us = nearest_whole(client.parameter(PERIOD_US)?, client.identity.period_us / 2)?;
    let quicker = [settings[0], (PERIOD_US, U32(period_us))];
    let mut run = Run::start(client, &quicker)?;
    // It doesn't run before.
    run.client.request(Stop {})?;
    if pins::arm(run.client)?.outcome == Accepted {
        run.listen(watchdog + watchdog / 4)?;
        equal("state after a wait in Armed", Armed, run.client.state)?;
        run.client.start()?;
    } else {
        client.reset()?;
        run = Run::start(client, &quicker)?;
    }
    let trip = fault_within(&mut run, PATIENCE, false)?;
    judge_trip(trip, watchdog_us, Some(0))?;
    no_torque(client, 0, Faulted)?;
    client.reset()?;
    let mut run = Run::start(client, &settings)?;
    run.refer(0.5)?;
    let early = fault_within(&mut run, 2 * watchdog, true)?;
    equal("with references in time, faults:", None, early.map(|it| it.code))?;
    let trip = fault_within(&mut run, PATIENCE, false)?;
    judge_trip(trip, watchdog_us, None)?;
    let answers = run.client.request(Reference { number: 9, reference_rad: 0.0 })?;
    let answers = of_kinds("to a Reference after the deadline", &["CommandResult"], answers)?;
    let got = (outcome::<Reference>(&answers)?, run.client.state);
    equal("outcome and state", (WrongState, Faulted), got)?;
    no_torque(client, 0, Faulted)
}

/// Requires the report of this watchdog, of a step if that is known.
fn judge_trip(trip: Option<FaultReport>, watchdog_us: u32, sequence: Option<u16>) -> RuleResult {
    let limit_s = 1e-6 * watchdog_us as f32;
    let Some(it) = trip else {
        return Err(broken(
            format!("a FaultReport {limit_s} s after the Start or the last Reference"),
            "none",
        ));
    };
    equal("code and detail", (FaultCode::Watchdog, 0), (it.code, it.detail))?;
    if let Some(reported) = sequence {
        expect(is_next(reported, it.sequence), format!("the last step, after {reported}"), it)?;
    }
    let is_near =
        (it.limit - limit_s).abs() <= 1e-6 && it.value >= it.limit && it.value <= limit_s + LATEST_S;
    expect(is_near, format!("a silence of more than {limit_s} s, and this limit"), it)
}

/// Whether this is the step reported last, or one after it: a drive may omit reports.
const fn is_next(reported: u16, sequence: u16) -> bool {
    sequence.wrapping_sub(reported) <= MOST_OMITTED
}

fn ends(client: &mut Client) -> RuleResult {
    let session = client.session;
    let of_next = hello(session.wrapping_add(1));
    let ends: [(HostMessage, State); 4] = [
        (Stop {}.into(), Idle),
        (EmergencyStop {}.into(), Faulted),
        (of_next.into(), Idle),
        (Reset {}.into(), Boot),
    ];
    for (end, state) in ends {
        client.reset()?;
        let mut run = Run::start(client, &[])?;
        let timing = run.timing();
        run.reports(5, 0.5)?;
        // One of another version ends nothing.
        run.client.request(other(session))?;
        let last = run.reports(3, 0.5)?.last().copied();
        let every = run.timing().every;
        let answers = run.client.request(end)?;
        if let Some(it) = answers.iter().find_map(of::<FaultReport>) {
            let last = answers.iter().filter_map(of::<BenchSample>).next_back().or(last);
            let reported = last.filter(|_| every == 1).map_or(it.sequence, |last| last.sequence);
            expect(is_next(reported, it.sequence), format!("the last step, after {reported}"), it)?;
            equal("value and limit of an EmergencyStop", (0.0, 0.0), (it.value, it.limit))?;
        }
        let after = answers.iter().skip_while(|it| is::<BenchSample>(it)).find(|it| is::<BenchSample>(it));
        equal(&format!("a report behind the answer to {}:", end.words()), None, after.copied())?;
        equal(&format!("state after {}", end.words()), state, run.client.state)?;
        let later = run.listen(run.pause())?;
        let what = format!("messages after the end of the run by {}:", end.words());
        equal(&what, Vec::new(), later.into_iter().filter(|it| !is::<Log>(it)).collect())?;
        pins::refuses_reference(client, Reference { number: 1, reference_rad: 0.0 }, state)?;
        if state == Idle {
            no_torque(client, 1, Idle)?;
        }
        if state == Faulted {
            // The run after a fault needs no `Reset`.
            client.request(ClearFault {})?;
            in_turn(&Run::again(client, timing)?.reports(3, 0.5)?, timing.every)?;
        }
    }
    // A run has sent kinds that no run of HIL mode has.
    client.reset()?;
    has_names(client)
}

/// Runs on the pins and on samples in turn, without a reset between them.
fn modes(client: &mut Client) -> RuleResult {
    let mut run = Run::start(client, &[])?;
    let (timing, pause) = (run.timing(), run.pause());
    for _ in 0..2 {
        in_turn(&run.reports(3, 0.5)?, timing.every)?;
        client.request(Stop {})?;
        client.put(SAMPLE_SOURCE, U32(0))?;
        client.running(&[])?;
        first_sample(client)?;
        accepted(client, sample(1), NONE)?;
        pins::refuses_reference(client, Reference { number: 1, reference_rad: 0.0 }, Running)?;
        let later = client.wait_for(pause, |message| is::<BenchSample>(message).then_some(*message))?;
        equal("BenchSample in HIL mode:", None, later)?;
        client.request(Stop {})?;
        client.put(SAMPLE_SOURCE, PINS)?;
        run = Run::again(client, timing)?;
        // A Reference that Armed refuses begins no step.
        let number = run.number;
        run.client.request(Stop {})?;
        if pins::arm(run.client)?.outcome == Accepted {
            pins::refuses_reference(run.client, Reference { number, reference_rad: 0.5 }, Armed)?;
            run.client.start()?;
            let early = run.listen(pause)?.into_iter().find(is::<BenchSample>);
            equal("BenchSample before a Reference in Running:", None, early)?;
        }
    }
    Ok(())
}
