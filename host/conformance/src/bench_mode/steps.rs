//! The steps of a run: their numbers, references, period, reports and telemetry.

use super::super::receiver::framed;
use super::super::safety::nearly_in_time;
use super::super::telemetry::subscription::signals;
use super::run::{Run, Timing, allowed, in_turn, steps_per_report};
use crate::prelude::checks::*;

/// Steps over which the period is measured: more than 8 bits count. Fewer if they would take longer than this.
const PACED_STEPS: u32 = 600;
const LONGEST_PACE_US: u32 = 600_000;
/// Error of the drive's clock against its own timer, and against the bench's clock, as fractions.
const OWN_CLOCK: f64 = 0.02;
const OTHER_CLOCK: f64 = 0.1;
/// Lateness of the bench with which its clock counts.
const LATEST: Duration = Duration::from_millis(4);
/// Least fraction of the reports that arrive.
const REPORTED: f64 = 0.9;
/// Steps whose reports are on their way, at either end.
const UNDERWAY: f64 = 3.0;

pub(super) fn checks() -> Vec<Check> {
    vec![
        allowed(
            "R18.6 R18.7",
            "the first Reference begins the steps, and each has the last one's number",
            steps,
        ),
        nearly_in_time(allowed("R18.6", "a step is made in every control period", |client| {
            let period_us = client.identity.period_us;
            pace(client, period_us)
        })),
        nearly_in_time(allowed(
            "R9.6 R18.6",
            "the control period of the steps is the one set before Arm",
            |client| {
                let period_us = client.identity.period_us;
                pace(client, period_us / 2)?;
                client.reset()?;
                pace(client, period_us + period_us / 4)
            },
        )),
        allowed(
            "R2.4 R3.4 R18.7",
            "a Reference that is too short is refused, and a longer one taken",
            bodies,
        ),
        allowed("R4.15 R18.9", "references count as messages of the line, and reports don't", line_counts),
        allowed("R18.7", "every n-th step is reported, the first included", every),
        allowed("R18.7", "telemetry follows every n-th step, after its report", telemetry),
    ]
}

fn steps(client: &mut Client) -> RuleResult {
    let limit_nm = client.real(TORQUE_LIMIT_NM).ok();
    let period_tenths_us = u64::from(client.identity.period_us) * 10;
    let mut run = Run::start(client, &[])?;
    let timing = run.timing();
    for round in ["first", "second"] {
        if round == "second" {
            run = Run::again(run.client, timing)?;
        }
        let early = run.listen(run.pause())?;
        let what = format!("messages before the first Reference of the {round} run:");
        equal(&what, Vec::new(), early.iter().filter(|it| is::<BenchSample>(it)).copied().collect())?;
        let mut reports = Vec::new();
        for reference_rad in [1.0, 0.5, 0.5, -1.0, 0.0] {
            let before = run.refer(reference_rad)?;
            reports.extend(before.iter().filter_map(of::<BenchSample>));
            let number = run.number;
            // The step that was due when it arrived may have had the one before.
            let after: Vec<_> = run.listen(run.pause())?.iter().filter_map(of::<BenchSample>).collect();
            let got: Vec<_> = after.iter().skip(2).map(|it| it.reference_number).collect();
            expect(!got.is_empty(), "reports after a Reference", "none")?;
            equal("number of the Reference in later reports", vec![number; got.len()], got)?;
            reports.extend(after);
        }
        in_turn(&reports, timing.every)?;
        for it in &reports {
            let flags = it.status.flags - TorqueFlags::SATURATED;
            equal("state and flags but SATURATED", (Running, NONE), (it.status.state, flags))?;
            let is_within = limit_nm.is_none_or(|limit_nm| it.torque_nm.abs() <= limit_nm);
            expect(is_within, "a finite torque within torque_limit_nm", it.torque_nm)?;
        }
        // One step may have been interrupted after the drive had looked at its end.
        let ended_late = |it: &BenchSample| {
            u64::from(it.lateness_tenths_us) + u64::from(it.compute_tenths_us) > period_tenths_us
        };
        expect(
            !reports.iter().all(ended_late),
            "a TickOverrun, or lateness and compute time within a period",
            DriveMessage::from(reports[0]),
        )?;
        let answers = run.client.request(Stop {})?;
        let answers = answers.into_iter().filter(|it| !is::<BenchSample>(it)).collect();
        of_kinds("answers to Stop", &["LineReport", "CommandResult"], answers)?;
    }
    Ok(())
}

/// Two runs that differ by some references, each with the request that shows its arrival.
fn line_counts(client: &mut Client) -> RuleResult {
    let mut counts = Vec::new();
    for references in [2, 12] {
        client.reset()?;
        let mut run = Run::start(client, &[])?;
        for _ in 0..references {
            run.refer(0.5)?;
        }
        let answers = run.client.request(Stop {})?;
        let it = find("a LineReport after Stop", &answers, of::<LineReport>)?;
        counts.push([it.messages, it.damaged, it.refused, it.overruns]);
    }
    let more: Vec<_> =
        counts[1].iter().zip(counts[0]).map(|(after, before)| after.wrapping_sub(before)).collect();
    equal("messages, damaged, refused and overruns of ten references more", vec![20, 0, 0, 0], more)?;
    equal("overruns of a run in bench mode", 0, counts[0][3])
}

fn bodies(client: &mut Client) -> RuleResult {
    let mut run = Run::start(client, &[])?;
    run.reports(1, 0.5)?;
    let body = |number: u16| [&[Reference::LAYOUT.kind][..], &number.to_le_bytes(), &[0; 4]].concat();
    let (short, long, second) = (run.number ^ 0x0100, run.number ^ 0x0200, run.number ^ 0x0400);
    let at_once = [run.number ^ 0x0300, second].map(|number| framed(&body(number))).concat();
    let shorter = (1..7).flat_map(|length| framed(&body(short)[..length])).collect::<Vec<_>>();
    for (what, bytes, wanted) in [
        ("too short a Reference", shorter, run.number),
        ("a longer Reference", framed(&[body(long), vec![9; 3]].concat()), long),
        ("two References at once", at_once, second),
    ] {
        run.client.request_bytes(&bytes)?;
        run.listen(run.pause())?;
        let after: Vec<_> = run.listen(run.pause())?.iter().filter_map(of::<BenchSample>).collect();
        let numbers: Vec<_> = after.iter().map(|it| it.reference_number).collect();
        expect(!numbers.is_empty(), "reports in a run", "none")?;
        equal(&format!("number of the Reference after {what}"), vec![wanted; numbers.len()], numbers)?;
    }
    Ok(())
}

/// The steps of a run with this period, against the drive's clock, or the bench's if the drive has none.
fn pace(client: &mut Client, period_us: u32) -> RuleResult {
    let period_us = nearest_whole(client.parameter(PERIOD_US)?, period_us)?;
    let count = PACED_STEPS.min(LONGEST_PACE_US / period_us.max(1));
    let mut run = Run::start(client, &[(PERIOD_US, U32(period_us))])?;
    let (mut first, mut last, mut reports) = (None, None, Vec::new());
    run.client.slowest = Duration::ZERO;
    let begun = Moment::latest(run.client);
    while begun.elapsed(run.client) < Duration::from_micros(LONGEST_PACE_US.into()) * 2 {
        reports.extend(run.refer(0.5)?.iter().filter_map(of::<BenchSample>));
        if let Some(BenchSample { sequence, .. }) = reports.last().copied() {
            let place = (sequence, Moment::latest(run.client));
            let (begun, _) = *first.get_or_insert(place);
            last = Some(place);
            if u32::from(sequence.wrapping_sub(begun)) >= count {
                break;
            }
        }
        reports.extend(run.turn()?.iter().filter_map(of::<BenchSample>));
    }
    // A drive may omit reports that its transmit buffer can't hold, which the line has room for.
    let due = reports.last().map_or(0, |it| it.sequence / run.timing().every);
    let expected = format!("most of {due} reports");
    expect(reports.len() as f64 >= REPORTED * f64::from(due), expected, reports.len())?;
    let (Some((first, from)), Some((last, to))) = (first, last) else {
        return expect(false, "reports after a Reference", "none");
    };
    if !from.has_own_clock() && run.client.slowest > LATEST {
        return Err(Failure::NotJudged { cause: "this machine is too busy to time the steps".to_owned() });
    }
    let tolerance = if from.has_own_clock() { OWN_CLOCK } else { OTHER_CLOCK };
    let passed = from.until(to);
    let periods = passed.div_duration_f64(Duration::from_micros(period_us.into()));
    let (least, most) = (periods * (1.0 - tolerance) - UNDERWAY, periods * (1.0 + tolerance) + UNDERWAY);
    let steps = last.wrapping_sub(first);
    let expected = format!("{least:.0} to {most:.0} steps of {period_us} us in {}", passed.words());
    expect((least..=most).contains(&f64::from(steps)), expected, steps)
}

fn every(client: &mut Client) -> RuleResult {
    let period = Duration::from_micros(client.identity.period_us.into());
    // The last one exceeds 8 bits.
    for (times, count) in [(2, 6), (3, 6), (10, 6), (300, 2)] {
        client.reset()?;
        let every = times * steps_per_report(client, period)?;
        let timing = Timing::of_every(client, &[], every)?;
        in_turn(&Run::start_at(client, timing, &[])?.reports(count, 0.5)?, timing.every)?;
    }
    Ok(())
}

fn telemetry(client: &mut Client) -> RuleResult {
    let signals = signals(client)?;
    let fitted = Timing::fitted(client, &[])?;
    // Of every fifth report, and twice as often as reports.
    for (steps, every) in [(1, 5), (2, 1)] {
        client.reset()?;
        let every = every * fitted.every;
        let timing = Timing::of_every(client, &[], steps * u32::from(fitted.every))?;
        let mut run = Run::start_with(client, timing, &[], Some(Subscribe { signals, every }))?;
        let (messages, _) = run.until(4, is::<Telemetry>, |_| 0.5)?;
        let (mut last, mut numbers) = (None, Vec::new());
        for message in &messages {
            match message {
                DriveMessage::BenchSample(it) => last = Some(it.sequence),
                DriveMessage::Telemetry(it) => {
                    if it.sequence.is_multiple_of(timing.every) {
                        equal("telemetry after the report of its step:", last, Some(it.sequence))?;
                    }
                    let count = it.values.as_slice().len();
                    equal("values in the telemetry:", signals.count_ones() as usize, count)?;
                    numbers.push(it.sequence);
                }
                _ => {}
            }
        }
        let wanted: Vec<_> = (0..numbers.len() as u16).map(|place| every * place).collect();
        equal(&format!("steps with telemetry, of every {every}:"), wanted, numbers)?;
        // The next run begins anew.
        run.client.request(Stop {})?;
        run = Run::again(run.client, timing)?;
        let (messages, _) = run.until(2, is::<Telemetry>, |_| 0.5)?;
        let numbers = messages.iter().filter_map(of::<Telemetry>).map(|it| it.sequence);
        equal("steps with telemetry in the next run", vec![0, every], numbers.take(2).collect())?;
        run.client.request(Subscribe { signals: 0, every: 0 })?;
        let later = run.listen(run.pause())?;
        let later = later.into_iter().find(is::<Telemetry>);
        equal("telemetry after the end of the subscription:", None, later)?;
    }
    Ok(())
}
