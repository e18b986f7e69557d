//! Bench mode on the drive's own encoders: its steps and reports, what restarts its watchdog, and what ends its runs.
//!
//! The power stage is on in these checks, so the host has to allow them. The duty is as near to that of no torque as the parameters
//! allow, and the encoders may stand still.

use std::time::Duration;

use lashloop_protocol::enums::{Capabilities, FaultCode, Outcome, ParameterValue, State, TorqueFlags};
use lashloop_protocol::message::{
    BenchSample, EmergencyStop, EncoderSample, FaultReport, Reference, Reset, Stop, Subscribe,
};
use lashloop_protocol::parameter_names::{SAMPLE_SOURCE, TORQUE_LIMIT_NM, WATCHDOG_US};
use lashloop_protocol::{DriveMessage, EncoderCounts, HostMessage};

use super::answers::{hello, other, outcome, torque};
use super::assertion::{Failure, RuleResult, broken, equal, expect, names, skip};
use super::check::{Check, check};
use super::client::Client;
use super::exchanges::result;
use super::pins::{self, PINS, has};
use super::range::{nearest_real, nearest_whole};
use super::telemetry::subscription::signals;
use super::words::{Bits, Words};

use State::{Boot, Faulted, Idle, Running};

const EVERY: &str = "bench_sample_every";
/// A pause without a step, and one between two references.
const PAUSE: Duration = Duration::from_millis(25);
const BETWEEN: Duration = Duration::from_millis(4);
/// Steps that are compared with HIL mode.
const STEPS: usize = 60;
/// Steps under torque, so that the mechanics leave their start, and steps without it.
const MOVING: usize = 150;
const COASTING: usize = 30;
/// Counts by which mechanics at rest may still move.
const AT_REST: i32 = 5;

pub(super) fn checks() -> Vec<Check> {
    vec![
        allowed(
            "R18.6 R18.7",
            "the first Reference begins the steps, and each has the last one's number",
            steps,
        ),
        allowed("R18.7", "every n-th step is reported, the first included", every),
        allowed("R18.1", "equal counts and references give the torques of HIL mode", same_torques),
        allowed("R18.7", "telemetry follows every n-th step, after its report", telemetry),
        allowed("R18.9", "an EncoderSample is refused, and the run continues", refused_sample),
        allowed("R18.10 R18.11", "a Reference, and nothing else, restarts the watchdog", watchdog),
        allowed("R18.5 R18.9", "no step follows Stop, a fault, a new session or Reset", ends),
        allowed("R18.14", "counts are those since power-up, each in the direction of its encoder", counts),
    ]
}

/// A check that a drive without bench mode, and a host that doesn't allow it, leave out.
fn allowed(rules: &'static str, name: &'static str, run: fn(&mut Client) -> RuleResult) -> Check {
    check(rules, name, move |client| {
        if !has(client, Capabilities::BENCH_MODE) {
            return skip("the drive has no bench mode");
        }
        if !client.allows_bench_mode {
            return skip("bench mode turns the power stage on; --bench-mode allows it");
        }
        run(client)
    })
}

/// References that were sent, in rad, by their numbers.
type Sent = Vec<(u16, f32)>;

/// A run in bench mode.
struct Run<'client> {
    client: &'client mut Client,
    /// Number of the last reference.
    number: u16,
}

impl<'client> Run<'client> {
    /// From `Boot`.
    fn start(client: &'client mut Client, settings: &[(&str, ParameterValue)]) -> Result<Self, Failure> {
        client.long_watchdog()?;
        for name in ["torque_per_duty_nm", "twist_limit_rad"] {
            let most = client.parameter(name)?.max;
            client.put(name, most)?;
        }
        client.put(SAMPLE_SOURCE, PINS)?;
        client.put_all(settings)?;
        Self::again(client)
    }

    /// From `Idle`, with the settings of the run before.
    fn again(client: &'client mut Client) -> Result<Self, Failure> {
        match pins::arm(client)?.outcome {
            Outcome::Accepted => {}
            _ => return skip("the pins of the drive allow no run"),
        }
        client.start()?;
        Ok(Self { client, number: 0x1234 })
    }

    /// Sends a reference and returns what came before the drive had taken it.
    fn refer(&mut self, reference_rad: f32) -> Result<Vec<DriveMessage>, Failure> {
        self.number = self.number.wrapping_add(0x3b1d);
        self.client.request(Reference { number: self.number, reference_rad })
    }

    /// What arrives for some time.
    fn listen(&mut self, time: Duration) -> Result<Vec<DriveMessage>, Failure> {
        let mut messages = Vec::new();
        self.client.wait_for(time, |message| {
            messages.push(*message);
            None::<()>
        })?;
        Ok(messages)
    }

    /// References until this many messages have arrived that `wanted` takes. Returns all messages.
    fn until(
        &mut self,
        count: usize,
        wanted: fn(&DriveMessage) -> bool,
        reference_rad: impl Fn(u16) -> f32,
    ) -> Result<(Vec<DriveMessage>, Sent), Failure> {
        let (mut messages, mut sent, mut turns) = (Vec::new(), Vec::new(), 0);
        while messages.iter().filter(|it| wanted(it)).count() < count {
            let reference_rad = reference_rad(turns);
            messages.extend(self.refer(reference_rad)?);
            sent.push((self.number, reference_rad));
            messages.extend(self.listen(BETWEEN)?);
            turns += 1;
            let of_fault = messages.iter().find(|it| matches!(it, DriveMessage::FaultReport(_)));
            if let Some(report) = of_fault {
                return Err(broken("a run in bench mode without a fault", report.words()));
            }
            if turns > 250 {
                return Err(broken(format!("{count} reports in bench mode"), messages.words()));
            }
        }
        Ok((messages, sent))
    }

    /// As [`Self::until`], for reports of steps, at a reference.
    fn reports(&mut self, count: usize, reference_rad: f32) -> Result<Vec<BenchSample>, Failure> {
        let (messages, _) = self.until(count, is_report, |_| reference_rad)?;
        Ok(messages.iter().filter_map(report).collect())
    }
}

const fn report(message: &DriveMessage) -> Option<BenchSample> {
    match message {
        DriveMessage::BenchSample(it) => Some(*it),
        _ => None,
    }
}

const fn is_report(message: &DriveMessage) -> bool {
    matches!(message, DriveMessage::BenchSample(_))
}

/// Requires the steps of a run from its start on, at this interval.
fn in_turn(reports: &[BenchSample], every: u16) -> RuleResult {
    let numbers: Vec<_> = reports.iter().map(|it| it.sequence).collect();
    let wanted: Vec<_> = (0..numbers.len() as u16).map(|place| place * every).collect();
    equal(&format!("numbers of the steps, with {EVERY} {every},"), wanted, numbers)
}

fn steps(client: &mut Client) -> RuleResult {
    let limit_nm = client.real(TORQUE_LIMIT_NM).ok();
    let mut run = Run::start(client, &[])?;
    for round in ["first", "second"] {
        if round == "second" {
            run = Run::again(run.client)?;
        }
        let early = run.listen(PAUSE)?;
        let what = format!("messages before the first Reference of the {round} run:");
        equal(&what, Vec::new(), early.iter().filter(|it| is_report(it)).copied().collect())?;
        let mut reports = Vec::new();
        for reference_rad in [1.0, 0.5, -1.0, 0.0] {
            let before = run.refer(reference_rad)?;
            reports.extend(before.iter().filter_map(report));
            let number = run.number;
            // The step that was due when it arrived may have had the one before.
            let after: Vec<_> = run.listen(PAUSE)?.iter().filter_map(report).collect();
            let got: Vec<_> = after.iter().skip(2).map(|it| it.reference_number).collect();
            expect(!got.is_empty(), "reports after a Reference", "none")?;
            equal("number of the Reference in later reports", vec![number; got.len()], got)?;
            reports.extend(after);
        }
        in_turn(&reports, 1)?;
        for it in &reports {
            let flags = it.status.flags - TorqueFlags::SATURATED;
            equal(
                "state and flags but SATURATED",
                (Running, TorqueFlags::empty()),
                (it.status.state, flags),
            )?;
            let is_within = limit_nm.is_none_or(|limit_nm| it.torque_nm.abs() <= limit_nm);
            expect(is_within, "a finite torque within torque_limit_nm", it.torque_nm)?;
        }
        let answers = run.client.request(Stop {})?;
        let answers: Vec<_> = answers.into_iter().filter(|it| !is_report(it)).collect();
        equal("answers to Stop", vec!["LineReport", "CommandResult"], names(&answers))?;
    }
    Ok(())
}

fn every(client: &mut Client) -> RuleResult {
    let parameter = |client: &Client| client.parameter(EVERY).cloned();
    for wished in [2, 3, 10] {
        let every = nearest_whole(&parameter(client)?, wished)?;
        client.reset()?;
        let mut run = Run::start(client, &[(EVERY, ParameterValue::U32(every))])?;
        let reports = run.reports(6, 0.5)?;
        in_turn(&reports, every as u16)?;
    }
    Ok(())
}

/// The drive itself in HIL mode is the reference: its own counts and references as samples.
fn same_torques(client: &mut Client) -> RuleResult {
    let mut run = Run::start(client, &[])?;
    let (messages, sent) = run.until(STEPS, is_report, |turn| 0.25 * f32::from(turn % 5))?;
    let reports: Vec<_> = messages.iter().filter_map(report).collect();
    in_turn(&reports, 1)?;
    client.reset()?;
    client.running(&[])?;
    for it in reports {
        let of_step = sent.iter().find(|(number, _)| *number == it.reference_number);
        let Some((_, reference_rad)) = of_step else {
            return Err(broken("the number of a Reference that was sent", it.reference_number.words()));
        };
        let BenchSample { sequence, motor_counts, load_counts, .. } = it;
        let sample = EncoderSample { sequence, motor_counts, load_counts, reference_rad: *reference_rad };
        let answer = torque(&client.request_one(sample)?)?;
        let of = |torque_nm: f32, flags: TorqueFlags| (Bits(torque_nm.to_bits()), flags);
        equal(
            &format!("torque in N m and flags of step {sequence}, as in HIL mode,"),
            of(answer.torque_nm, answer.status.flags),
            of(it.torque_nm, it.status.flags),
        )?;
    }
    Ok(())
}

fn telemetry(client: &mut Client) -> RuleResult {
    let signals = signals(client)?;
    client.idle()?;
    client.exchange("in Idle", &[result(Subscribe { signals, every: 2 }, Outcome::Accepted, Idle)])?;
    let mut run = Run::start(client, &[])?;
    let (messages, _) = run.until(4, |it| matches!(it, DriveMessage::Telemetry(_)), |_| 0.5)?;
    let (mut last, mut numbers) = (None, Vec::new());
    for message in &messages {
        match message {
            DriveMessage::BenchSample(it) => last = Some(it.sequence),
            DriveMessage::Telemetry(it) => {
                equal("telemetry after the report of its step:", last, Some(it.sequence))?;
                let count = it.values.as_slice().len();
                equal("values in the telemetry:", signals.count_ones() as usize, count)?;
                numbers.push(it.sequence);
            }
            _ => {}
        }
    }
    let wanted: Vec<_> = (0..numbers.len() as u16).map(|place| 2 * place).collect();
    equal("steps with telemetry at every second one", wanted, numbers)
}

fn refused_sample(client: &mut Client) -> RuleResult {
    let mut run = Run::start(client, &[])?;
    let before = run.reports(3, 0.5)?.len();
    let zero = EncoderCounts::default();
    for sequence in [0, before as u16] {
        let sample = EncoderSample { sequence, motor_counts: zero, load_counts: zero, reference_rad: 0.0 };
        let answers: Vec<_> = run.client.request(sample)?.into_iter().filter(|it| !is_report(it)).collect();
        equal("to an EncoderSample in bench mode", vec!["CommandResult"], names(&answers))?;
        let got = (outcome::<EncoderSample>(&answers)?, run.client.state);
        equal("outcome and state", (Outcome::WrongState, Running), got)?;
        run.reports(3, 0.5)?;
    }
    Ok(())
}

/// Until the watchdog's report, or for some time.
fn fault_within(run: &mut Run<'_>, time: Duration, keep_alive: bool) -> Result<Option<FaultReport>, Failure> {
    let ends_at = run.client.line.now() + time;
    while run.client.line.now() < ends_at {
        let mut messages = if keep_alive { run.refer(0.5)? } else { run.client.request_bytes(&[])? };
        messages.extend(run.listen(BETWEEN)?);
        let found = messages.iter().find_map(|it| match it {
            DriveMessage::FaultReport(it) => Some(*it),
            _ => None,
        });
        if found.is_some() {
            return Ok(found);
        }
    }
    Ok(None)
}

fn watchdog(client: &mut Client) -> RuleResult {
    let watchdog_us = nearest_whole(client.parameter(WATCHDOG_US)?, 60_000)?;
    let watchdog = Duration::from_micros(watchdog_us.into());
    let mut run = Run::start(client, &[(WATCHDOG_US, ParameterValue::U32(watchdog_us))])?;
    run.refer(0.5)?;
    run.client.slowest = Duration::ZERO;
    let early = fault_within(&mut run, 3 * watchdog, true)?;
    if run.client.slowest > watchdog / 2 {
        return Err(Failure::NotJudged {
            cause: "this machine is too busy to send references in time".to_owned(),
        });
    }
    equal("with references in time, faults:", None, early.map(|it| it.code))?;
    let Some(report) = fault_within(&mut run, 2 * watchdog + PAUSE, false)? else {
        return Err(broken(format!("a FaultReport {} after the last Reference", watchdog.words()), "none"));
    };
    equal("code", FaultCode::Watchdog, report.code)?;
    let late: HostMessage = Reference { number: 9, reference_rad: 0.0 }.into();
    let answers = run.client.request(late)?;
    equal("to a Reference after the deadline", vec!["CommandResult"], names(&answers))?;
    let got = (outcome::<Reference>(&answers)?, run.client.state);
    equal("outcome and state", (Outcome::WrongState, Faulted), got)
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
        run.reports(5, 0.5)?;
        // One of another version ends nothing.
        run.client.request(other(session))?;
        run.reports(3, 0.5)?;
        run.client.request(end)?;
        equal(&format!("state after {}", end.words()), state, run.client.state)?;
        let later = run.listen(PAUSE)?;
        let what = format!("messages after the end of the run by {}:", end.words());
        equal(
            &what,
            Vec::new(),
            later.into_iter().filter(|it| !matches!(it, DriveMessage::Log(_))).collect(),
        )?;
        pins::refuses_reference(client, Reference { number: 1, reference_rad: 0.0 }, state)?;
    }
    Ok(())
}

/// Counts of motor and load in the first and the last step of a run without torque, and how far they drift meanwhile.
fn coast(client: &mut Client, reversed: Option<&str>) -> Result<[[i32; 2]; 3], Failure> {
    let least_nm = nearest_real(client.parameter(TORQUE_LIMIT_NM)?, 0.0)?;
    let mut settings = vec![(TORQUE_LIMIT_NM, ParameterValue::F32(least_nm))];
    settings.extend(reversed.map(|name| (name, ParameterValue::U32(1))));
    let reports = Run::start(client, &settings)?.reports(COASTING, 0.0)?;
    client.reset()?;
    let of = |place: usize| [reports[place].motor_counts.get(), reports[place].load_counts.get()];
    let (first, last) = (of(0), of(reports.len() - 1));
    Ok([first, last, [0, 1].map(|axis| (last[axis] - first[axis]).abs())])
}

fn counts(client: &mut Client) -> RuleResult {
    Run::start(client, &[])?.reports(MOVING, 1.0)?;
    client.reset()?;
    let mut is_judged = false;
    for (reversed, signs) in
        [(None, [1, 1]), (Some("motor_direction"), [-1, 1]), (Some("load_direction"), [1, -1])]
    {
        let [_, last, drift] = coast(client, None)?;
        let [first, ..] = coast(client, reversed)?;
        for axis in 0..2 {
            let (wanted, tolerance) = (signs[axis] * last[axis], 3 * drift[axis] + AT_REST);
            // What rests at its start, or moves fast, has no direction that shows.
            if wanted.abs() > 2 * tolerance {
                is_judged = true;
                let encoder = ["motor", "load"][axis];
                let direction = reversed.map_or_else(String::new, |name| format!(" with {name} reverse"));
                let expected = format!("{encoder} counts near {wanted} in the next run{direction}");
                expect((first[axis] - wanted).abs() <= tolerance, expected, first[axis])?;
            }
        }
    }
    if is_judged { Ok(()) } else { skip("the mechanics at the pins don't move, or never rest") }
}
