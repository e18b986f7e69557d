//! A run in bench mode.

use super::super::pins::{self, PINS, UNREAD, has};
use crate::prelude::checks::*;

const TORQUE_PER_DUTY_NM: &str = "torque_per_duty_nm";
pub(super) const TWIST_LIMIT_RAD: &str = "twist_limit_rad";
/// A pause without a step, and one between two references, on a quick drive.
const PAUSE: Duration = Duration::from_millis(25);
const BETWEEN: Duration = Duration::from_millis(4);
/// Waits for the drive's clock at most: an emulated drive may be so many times slower.
const MOST_LISTENS: u32 = 20;
/// Exchanges that are timed by the drive's clock.
const EXCHANGES: u32 = 8;
/// Time by which the steps of a run may be late.
const LATEST: Duration = Duration::from_secs(1);
/// Time with references before a fault, and starts that wait for the mechanics, at most.
const FAULT_LIMIT: Duration = Duration::from_millis(500);
const MOST_WAITS: u32 = 100;
/// From one number to the next; the second one is 0.
const NUMBER_STEP: u16 = 0x3b1d;
const FIRST_NUMBER: u16 = 0_u16.wrapping_sub(2 * NUMBER_STEP);
const NO_RUN: &str = "the pins of the drive allow no run";

/// A check that a drive without bench mode, and a host that doesn't allow it, leave out.
pub(super) fn allowed(
    rules: &'static str,
    name: impl Into<String>,
    run: impl Fn(&mut Client) -> RuleResult + 'static,
) -> Check {
    check(rules, name, move |client| {
        if !has(client, Capabilities::BENCH_MODE) {
            return skip("the drive has no bench mode");
        }
        if client.bench_mode.is_none() {
            return skip("bench mode turns the power stage on; --bench-mode allows it");
        }
        run(client)
    })
}

/// References that were sent, in rad, by their numbers.
pub(super) type Sent = Vec<(u16, f32)>;

/// A run in bench mode.
pub(super) struct Run<'client> {
    pub(super) client: &'client mut Client,
    /// Number of the last reference.
    pub(super) number: u16,
    timing: Timing,
}

/// Steps, reports and references of a run.
#[derive(Clone, Copy)]
pub(super) struct Timing {
    /// Steps for each report.
    pub(super) every: u16,
    period: Duration,
    /// Time between two references.
    turn: Duration,
}

impl Timing {
    /// Of reports as often as the line has room for, and a reference for each, or more.
    pub(super) fn fitted(client: &mut Client, settings: &[Setting]) -> Result<Self, Failure> {
        let period = period(client, settings);
        let every = steps_per_report(client, period)?;
        let every = nearest_whole(client.parameter(BENCH_SAMPLE_EVERY)?, every)?;
        Ok(Self { every: every as u16, period, turn: BETWEEN.max(period * every) })
    }

    /// Of a report of every step, if the line has room for it; little else may be sent then.
    pub(super) fn of_each(client: &mut Client, settings: &[Setting]) -> Result<Self, Failure> {
        let period = period(client, settings);
        let (by_drive, _) = shortest_exchange(client)?;
        // Its frames are longer than a report.
        let timing = Self::of_every(client, settings, steps(by_drive, period))?;
        if timing.every == 1 {
            return Ok(timing);
        }
        skip("not judged: this line is too slow for a report of every step")
    }

    /// Of a report of every n-th step, as near as the range of the parameter allows.
    pub(super) fn of_every(client: &Client, settings: &[Setting], every: u32) -> Result<Self, Failure> {
        let every = nearest_whole(client.parameter(BENCH_SAMPLE_EVERY)?, every)?;
        let period = period(client, settings);
        Ok(Self { every: every as u16, period, turn: BETWEEN.max(period) })
    }
}

/// Steps of this period for each report of one, so that the line has room for reports, telemetry, references and answers.
pub(super) fn steps_per_report(client: &mut Client, period: Duration) -> Result<u32, Failure> {
    if steps(client.exchange, period) == 1 {
        return Ok(1);
    }
    let (by_drive, by_bench) = shortest_exchange(client)?;
    let slowness = by_drive.div_duration_f64(by_bench).min(1.0);
    Ok(steps(client.exchange.mul_f64(slowness), period))
}

/// An exchange is a little longer than its frames.
fn steps(exchange: Duration, period: Duration) -> u32 {
    (0.8 * exchange.div_duration_f64(period)).ceil().max(1.0) as u32
}

/// Mean time of the shortest request with its answer, by the drive's clock and by the bench's.
fn shortest_exchange(client: &mut Client) -> Result<(Duration, Duration), Failure> {
    client.request_bytes(&[])?;
    let (before, began) = (Moment::latest(client), client.line.now());
    for _ in 0..EXCHANGES {
        client.request_bytes(&[])?;
    }
    let passed = client.line.now().saturating_duration_since(began);
    Ok((before.elapsed(client) / EXCHANGES, passed / EXCHANGES))
}

/// Starts, unless what still moves has exceeded a limit since `Arm`.
fn has_started(client: &mut Client) -> Result<bool, Failure> {
    let session = client.session;
    let answers = client.request(Start { session })?;
    let it = command_result(&Start::LAYOUT, &answers)?;
    if it.outcome == EncoderImplausible {
        return Ok(false);
    }
    let got = (it.outcome, client.state);
    equal("Start in bench mode: outcome and state", (Accepted, Running), got)?;
    Ok(true)
}

/// In `Idle`, a torque limit that has a duty at the known scale.
pub(super) fn limit_torque(client: &mut Client) -> RuleResult {
    let Some(scale_nm) = client.bench_mode.and_then(|it| it.torque_per_duty_nm) else { return Ok(()) };
    let [min, offset, max] = ["duty_min", "duty_offset", "duty_max"].map(|name| client.real(name));
    let (min, offset, max) = (min?, offset?, max?);
    let most_nm = 0.99 * scale_nm * (offset - min).min(max - offset);
    let limit_nm = client.real(TORQUE_LIMIT_NM)?;
    if limit_nm > most_nm {
        let limit_nm = nearest_real(client.parameter(TORQUE_LIMIT_NM)?, most_nm)?;
        client.put(TORQUE_LIMIT_NM, F32(limit_nm))?;
    }
    Ok(())
}

/// The control period of a run with these settings.
fn period(client: &Client, settings: &[Setting]) -> Duration {
    let set = settings.iter().find_map(|(name, value)| match value {
        U32(period_us) if *name == PERIOD_US => Some(*period_us),
        _ => None,
    });
    Duration::from_micros(set.unwrap_or(client.identity.period_us).into())
}

impl<'client> Run<'client> {
    /// From `Boot`, with as many reports as the line has room for.
    pub(super) fn start(client: &'client mut Client, settings: &[Setting]) -> Result<Self, Failure> {
        let timing = Timing::fitted(client, settings)?;
        Self::start_at(client, timing, settings)
    }

    /// From `Boot`. Waits until the mechanics of a run before have come to rest, if the drive requires it.
    pub(super) fn start_at(
        client: &'client mut Client,
        timing: Timing,
        settings: &[Setting],
    ) -> Result<Self, Failure> {
        Self::start_with(client, timing, settings, None)
    }

    /// As [`Self::start_at`], with telemetry.
    pub(super) fn start_with(
        client: &'client mut Client,
        timing: Timing,
        settings: &[Setting],
        subscription: Option<Subscribe>,
    ) -> Result<Self, Failure> {
        for _ in 0..MOST_WAITS {
            client.long_watchdog()?;
            let [scale, twist] =
                [TORQUE_PER_DUTY_NM, TWIST_LIMIT_RAD].map(|name| client.parameter(name).map(|it| it.max));
            let known_nm = client.bench_mode.and_then(|it| it.torque_per_duty_nm);
            client.put(TORQUE_PER_DUTY_NM, known_nm.map_or(scale?, F32))?;
            limit_torque(client)?;
            client.put(TWIST_LIMIT_RAD, twist?)?;
            client.put_all(&[(SAMPLE_SOURCE, PINS), (BENCH_SAMPLE_EVERY, U32(timing.every.into()))])?;
            client.put_all(settings)?;
            if let Some(subscription) = subscription {
                client.exchange("in Idle", &[result(subscription, Accepted, Idle)])?;
            }
            let it = pins::arm(client)?;
            match it.outcome {
                Accepted => {
                    if has_started(client)? {
                        return Ok(Self { client, number: FIRST_NUMBER, timing });
                    }
                }
                EncoderImplausible => {}
                Inconsistent if settings.is_empty() => {
                    let expected =
                        "Arm in bench mode, with the widest limits and else the defaults, Accepted";
                    return Err(broken(expected, it.words()));
                }
                _ => return skip(NO_RUN),
            }
            client.wait_for(PAUSE, |_| None::<()>)?;
            // What has moved counts until the next reset.
            if it.detail != UNREAD {
                client.reset()?;
            }
        }
        skip(NO_RUN)
    }

    /// From `Idle`, with the settings of the run before.
    pub(super) fn again(client: &'client mut Client, timing: Timing) -> Result<Self, Failure> {
        if pins::arm(client)?.outcome != Accepted {
            return skip(NO_RUN);
        }
        client.start()?;
        Ok(Self { client, number: FIRST_NUMBER, timing })
    }

    pub(super) const fn timing(&self) -> Timing {
        self.timing
    }

    /// A pause in which several reports are due.
    pub(super) fn pause(&self) -> Duration {
        PAUSE.max(8 * self.timing.turn)
    }

    /// What arrives until the next reference.
    pub(super) fn turn(&mut self) -> Result<Vec<DriveMessage>, Failure> {
        self.wait(self.timing.turn)
    }

    /// Sends a reference and returns what came before the drive had taken it.
    pub(super) fn refer(&mut self, reference_rad: f32) -> Result<Vec<DriveMessage>, Failure> {
        self.number = self.number.wrapping_add(NUMBER_STEP);
        self.refer_again(reference_rad)
    }

    /// As [`Self::refer`], with the number of the last one.
    pub(super) fn refer_again(&mut self, reference_rad: f32) -> Result<Vec<DriveMessage>, Failure> {
        let messages = self.client.request(Reference { number: self.number, reference_rad })?;
        let answer = messages.iter().copied().find(is::<CommandResult>);
        let is_refused = messages.iter().any(is::<FaultReport>);
        expect(answer.is_none() || is_refused, "no answer to a Reference in Running", answer)?;
        Ok(messages)
    }

    /// What arrives for some time, by the drive's clock too.
    pub(super) fn listen(&mut self, time: Duration) -> Result<Vec<DriveMessage>, Failure> {
        let mut messages = self.client.request_bytes(&[])?;
        let before = Moment::latest(self.client);
        for _ in 0..MOST_LISTENS {
            messages.extend(self.wait(time)?);
            messages.extend(self.client.request_bytes(&[])?);
            if before.until(Moment::latest(self.client)) >= time.mul_f64(0.9) {
                break;
            }
        }
        Ok(messages)
    }

    /// What arrives for some time.
    fn wait(&mut self, time: Duration) -> Result<Vec<DriveMessage>, Failure> {
        let mut messages = Vec::new();
        self.client.wait_for(time, |message| {
            messages.push(*message);
            None::<()>
        })?;
        Ok(messages)
    }

    /// References until this many messages have arrived that `wanted` takes. Returns all messages.
    pub(super) fn until(
        &mut self,
        count: usize,
        wanted: fn(&DriveMessage) -> bool,
        reference_rad: impl Fn(u16) -> f32,
    ) -> Result<(Vec<DriveMessage>, Sent), Failure> {
        let (mut messages, mut sent, mut turns) = (Vec::new(), Vec::new(), 0);
        let due = self.timing.period * self.timing.every.into() * count as u32;
        let begun = Moment::latest(self.client);
        while messages.iter().filter(|it| wanted(it)).count() < count {
            let reference_rad = reference_rad(turns);
            messages.extend(self.refer(reference_rad)?);
            sent.push((self.number, reference_rad));
            messages.extend(self.turn()?);
            turns += 1;
            if let Some(report) = messages.iter().find_map(of::<FaultReport>) {
                return Err(broken("a run in bench mode without a fault", report.words()));
            }
            if begun.elapsed(self.client) > 4 * due + LATEST {
                return Err(broken(format!("{count} reports in bench mode"), messages.words()));
            }
        }
        Ok((messages, sent))
    }

    /// As [`Self::until`], for reports of steps, at a reference.
    pub(super) fn reports(&mut self, count: usize, reference_rad: f32) -> Result<Vec<BenchSample>, Failure> {
        let (messages, _) = self.until(count, is::<BenchSample>, |_| reference_rad)?;
        Ok(messages.iter().filter_map(of::<BenchSample>).collect())
    }

    /// The reports of steps at a reference and, if one comes, the report of a fault, which ends them.
    pub(super) fn until_fault(
        &mut self,
        reference_rad: f32,
    ) -> Result<(Vec<BenchSample>, Option<FaultReport>), Failure> {
        let (mut reports, mut fault) = (Vec::<BenchSample>::new(), None);
        let begun = Moment::latest(self.client);
        while begun.elapsed(self.client) < FAULT_LIMIT {
            let mut messages = self.refer(reference_rad)?;
            messages.extend(self.turn()?);
            for message in &messages {
                let is_in_order = fault.is_none() || !is::<BenchSample>(message);
                expect(is_in_order, "no BenchSample after a FaultReport", *message)?;
                let of_fault = |it: &BenchSample| it.status.state != Running;
                let follows = is::<Telemetry>(message) && reports.last().is_some_and(of_fault);
                expect(!follows, "no Telemetry of the step that causes a fault", *message)?;
                reports.extend(of::<BenchSample>(message));
                fault = fault.or_else(|| of::<FaultReport>(message));
            }
            if fault.is_some() {
                break;
            }
        }
        Ok((reports, fault))
    }
}

/// Requires the steps of a run from its start on, at this interval.
pub(super) fn in_turn(reports: &[BenchSample], every: u16) -> RuleResult {
    let numbers: Vec<_> = reports.iter().map(|it| it.sequence).collect();
    let wanted: Vec<_> = (0..numbers.len() as u16).map(|place| place * every).collect();
    equal(&format!("numbers of the steps, with {BENCH_SAMPLE_EVERY} {every},"), wanted, numbers)
}
