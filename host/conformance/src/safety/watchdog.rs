//! The watchdog: in `Running` only, fed by accepted samples only, in time.
//!
//! Real time passes in these checks, so the watchdogs are short. A wait that a busy bench may have stretched is tried again
//! before it counts against the drive.

use super::super::judge::ATTEMPTS;
use super::super::reactions::reported_to;
use super::super::receiver::framed;
use super::faults::stays_latched;
use super::late;
use super::timing::{
    CLOCK_TOLERANCE, LONGEST_ATTEMPT, QUICK, in_time, micros, nearly_in_time, start_with, too_busy,
};
use crate::prelude::checks::*;

/// Watchdog of most of these checks: short for a quick check, long enough for the first sample of a busy bench.
const WATCHDOG: Duration = Duration::from_millis(100);
/// A watchdog much longer than [`LATEST`], so that a drive that waits twice as long is late.
const LONGER: Duration = Duration::from_millis(400);
/// Time without a sample in states without a watchdog.
const QUIET: Duration = Duration::from_millis(150);
/// The drive must latch the fault this long after the limit.
const LATEST: Duration = Duration::from_millis(100);
/// A report takes this long from the drive to the bench at most, unless the bench is busy.
const TRANSPORT: Duration = Duration::from_millis(100);
/// Timeout for a watchdog that must trip.
const PATIENCE: Duration = Duration::from_secs(1);
/// Periods of a gap, so that few samples lead far into a run.
const FEWEST: u16 = 200;
/// Time between two frames that must not feed the watchdog.
const INTERVAL: Duration = Duration::from_millis(1);

pub(super) fn checks() -> Vec<Check> {
    let checks = vec![
        check(
            "R5.2 R8.5 R8.7 R8.8 R8.10",
            "without samples the watchdog trips, and not early",
            trips_in_time,
        ),
        check("R8.5 R6.9", "the watchdog runs from the Start, and in no other state", |client| {
            stays(client, Boot)?;
            client.idle()?;
            client.put(WATCHDOG_US, micros(WATCHDOG))?;
            stays(client, Idle)?;
            client.arm()?;
            stays(client, Armed)?;
            let before = client.line.now();
            client.start()?;
            let it = tripped(client, WATCHDOG, 0, before)?.report;
            stays_latched(client, it)?;
            equal("ClearFault", (Accepted, Idle), client.command(ClearFault {})?)?;
            stays(client, Idle)
        }),
        check("R8.5", "Stop and a new session end the watchdog", |client| {
            start_with(client, WATCHDOG)?;
            client.command(Stop {})?;
            stays(client, Idle)?;
            client.arm_and_start()?;
            first_sample(client)?;
            client.request(hello(client.session ^ 1))?;
            stays(client, Idle)
        }),
        check("R8.2", "after the watchdog has tripped there is no torque", |client| {
            start_with(client, WATCHDOG)?;
            let before = client.line.now();
            let it = tripped(client, WATCHDOG, 0, before)?.report;
            [1, 0, 2].into_iter().try_for_each(|sequence| no_torque(client, sequence, Faulted))?;
            still_reported(client, it)
        }),
        check(
            "R8.4 R8.5",
            "far into a run the watchdog trips, and its report has the last sample",
            far_into_a_run,
        ),
        check("R8.6", "each accepted sample restarts the watchdog", samples_in_time),
        check("R7.2 R8.6", "stray samples before the first one do not feed the watchdog", strays_first),
        check("R8.9 R7.1", "a sample later than the watchdog gets no torque", late::late_samples),
    ];
    let mut checks: Vec<_> = checks.into_iter().map(in_time).collect();
    checks.extend(feeds().map(nearly_in_time));
    checks
}

/// Requires that time passes in `state` without a fault.
fn stays(client: &mut Client, state: State) -> RuleResult {
    let news = client.wait_for(QUIET, of::<FaultReport>)?;
    expect(news.is_none(), format!("no FaultReport in {state:?}"), news)?;
    client.request_bytes(&[])?;
    equal("state", state, client.state)
}

/// A watchdog that has tripped.
struct Trip {
    report: FaultReport,
    /// From the last accepted sample, as answered, to the report; the bench's clock.
    waited: Duration,
}

/// Requires the report of a watchdog, not early. `before` is a time before the drive received the last accepted sample.
fn tripped(client: &mut Client, limit: Duration, sequence: u16, before: Instant) -> Result<Trip, Failure> {
    let after = client.line.now();
    let found = client.wait_for(limit + PATIENCE, of::<FaultReport>)?;
    judged(client, limit, sequence, [before, after], found)
}

/// As [`tripped`], with frames that must not feed the watchdog after three quarters of its time.
fn tripped_through_feeds(client: &mut Client, limit: Duration, before: Instant) -> Result<Trip, Failure> {
    let after = client.line.now();
    let mut found = client.wait_for(limit.mul_f64(0.75), of::<FaultReport>)?;
    // On a busy bench the watchdog may trip here, and would be cleared.
    if found.is_none() && client.line.now().saturating_duration_since(after) < limit.mul_f64(0.85) {
        client.request(ClearFault {})?;
    }
    for (_, _, feed) in FEEDS {
        for count in 0..5 {
            let answers = client.request_bytes(&feed(client, count))?;
            found = found.or(answers.iter().find_map(of::<FaultReport>));
        }
    }
    if found.is_none() {
        found = client.wait_for(limit + PATIENCE, of::<FaultReport>)?;
    }
    judged(client, limit, 2, [before, after], found)
}

/// Judges the report that arrived now, if one did. The drive received the last accepted sample between the two times.
fn judged(
    client: &mut Client,
    limit: Duration,
    sequence: u16,
    [before, after]: [Instant; 2],
    found: Option<FaultReport>,
) -> Result<Trip, Failure> {
    let limit_s = limit.as_secs_f32();
    let report = found.ok_or_else(|| {
        let got = format!("nothing within {}", (limit + PATIENCE).words());
        broken(format!("a FaultReport {limit_s} s after the last accepted sample"), got)
    })?;
    let now = client.line.now();
    let (waited, longest) = (now.saturating_duration_since(after), now.saturating_duration_since(before));
    let got = (report.code, report.sequence, report.detail);
    equal("code, sequence and detail", (FaultCode::Watchdog, sequence, 0), got)?;
    let near = (report.limit - limit_s).abs() <= 1e-6;
    expect(near, format!("a limit of {limit_s} s"), format!("{} s", report.limit))?;
    let most_s = limit_s + LATEST.mul_f64(1.0 + CLOCK_TOLERANCE).as_secs_f32();
    let in_time = report.value >= report.limit && report.value <= most_s;
    expect(in_time, format!("a silence of {limit_s} to {most_s:.3} s"), format!("{} s", report.value))?;
    let least = limit.mul_f64(1.0 - CLOCK_TOLERANCE);
    let expected = format!("the FaultReport {} after the last accepted sample or later", least.words());
    expect(longest >= least, expected, longest)?;
    equal("to the FaultReport, state", Faulted, {
        client.request_bytes(&[])?;
        client.state
    })?;
    Ok(Trip { report, waited })
}

/// Again with the longer watchdog if the first report is late, then in a second run with another value.
fn trips_in_time(client: &mut Client) -> RuleResult {
    let latest = (LONGER + LATEST).mul_f64(1.0 + CLOCK_TOLERANCE) + TRANSPORT;
    for attempt in 1.. {
        start_with(client, LONGER)?;
        // The silence counts from the last sample, not from the first.
        client.wait_for(WATCHDOG.mul_f64(1.5), |_| None::<()>)?;
        accepted(client, sample(1), NONE)?;
        let before = client.line.now();
        accepted(client, sample(2), NONE)?;
        let trip = tripped_through_feeds(client, LONGER, before)?;
        client.note = format!("tripped {:.1} ms after the last sample, device time", 1e3 * trip.report.value);
        if trip.waited <= latest {
            break;
        }
        let expected = format!("the FaultReport within {}", latest.words());
        expect(attempt < ATTEMPTS, expected, trip.waited)?;
        client.reset()?;
    }
    client.command(ClearFault {})?;
    client.put(WATCHDOG_US, micros(WATCHDOG))?;
    client.arm_and_start()?;
    first_sample(client)?;
    accepted(client, sample(1), NONE)?;
    let before = client.line.now();
    accepted(client, sample(2), NONE)?;
    let it = tripped(client, WATCHDOG, 2, before)?.report;
    reported_to(client, client.session ^ 1, it)
}

/// Beyond 2^15 samples.
fn far_into_a_run(client: &mut Client) -> RuleResult {
    let setup = Setup::coarse(client)?;
    let gap = setup.longest_gap();
    if gap < FEWEST {
        return skip(
            "not run: the encoders of this drive allow no long gaps, so the way takes too many samples",
        );
    }
    setup.allowed(client)?;
    client.running(&[&setup.settings()[..], &[(WATCHDOG_US, micros(WATCHDOG))]].concat())?;
    first_sample(client)?;
    let (mut sequence, mut before) = (0, client.line.now());
    while sequence < 1 << 15 {
        sequence += gap;
        before = client.line.now();
        client.torque(sequence)?;
    }
    tripped(client, WATCHDOG, sequence, before).map(drop)
}

/// Samples whose intervals are in time and whose sum is not.
fn samples_in_time(client: &mut Client) -> RuleResult {
    for attempt in 0..=LONGEST_ATTEMPT {
        client.reset()?;
        client.idle()?;
        // Longer each time, so that a busy bench sends them in time.
        let watchdog = WATCHDOG * 2_u32.pow(attempt);
        client.put(WATCHDOG_US, micros(watchdog))?;
        // A limited torque counts as well as any.
        client.put(TORQUE_LIMIT_NM, F32(0.0))?;
        client.arm()?;
        let (mut sent, mut longest) = (client.line.now(), Duration::ZERO);
        client.start()?;
        for sequence in 0..QUICK + 3 {
            // The first ones, and those after some in quick succession.
            if !(2..QUICK).contains(&sequence) {
                client.wait_for(watchdog.mul_f64(0.6), |_| None::<()>)?;
            }
            let earlier = std::mem::replace(&mut sent, client.line.now());
            // The last ones after gaps.
            client.torque(sequence + sequence.saturating_sub(QUICK))?;
            longest = longest.max(client.line.now().saturating_duration_since(earlier));
        }
        if client.state == Running {
            return Ok(());
        }
        let least = watchdog.mul_f64(1.0 - CLOCK_TOLERANCE);
        let expected = format!("Running with samples at most {} apart", longest.words());
        expect(longest >= least, expected, client.state)?;
    }
    Err(too_busy())
}

/// Bytes that do not feed the watchdog. The number counts the writes.
pub(crate) type Feed = fn(&Client, usize) -> Vec<u8>;

pub(crate) const FEEDS: [(&str, &str, Feed); 5] = [
    ("R8.6", "repeating one sample does not feed the watchdog", |_, _| frame(sample(2))),
    ("R8.6", "stray samples do not feed the watchdog", |_, count| {
        frame(sample(if count.is_multiple_of(2) { 1 } else { 5000 }))
    }),
    ("R8.6", "other requests do not feed the watchdog", requests),
    ("R4.17 R8.6", "unknown requests do not feed the watchdog", |_, _| {
        [framed(&[0x41, 0, 1, 1]), framed(&[0x1c, 1, 1])].concat()
    }),
    ("R2.6 R8.6", "damaged and refused frames do not feed the watchdog", |_, count| {
        let mut bytes = frame(sample(3));
        match count % 5 {
            0 => bytes[3] ^= if bytes[3] == 1 { 2 } else { 1 },
            1 => return DriveMessage::from(counted(0, 0, 0)).frame().to_vec(),
            // Not COBS.
            2 => return vec![9, 9, DELIMITER],
            // A sample and a reference without their ends.
            3 => return [framed(&[0x10, 3, 0]), framed(&[0x11, 9, 0])].concat(),
            // Too long, after a delimiter.
            _ => bytes = [&[DELIMITER][..], &[5; 70]].concat(),
        }
        bytes.push(DELIMITER);
        bytes
    }),
];

/// Stray samples from the start on, as the first one is 0.
fn strays_first(client: &mut Client) -> RuleResult {
    client.idle()?;
    client.put(WATCHDOG_US, micros(WATCHDOG))?;
    client.arm_if_consistent()?;
    client.start()?;
    unfed(client, 0, |_, count| frame(sample(5000_u16.wrapping_add(count as u16))))
}

/// Requires the watchdog to trip through these writes. `last` is the sequence of the last accepted sample.
fn unfed(client: &mut Client, last: u16, feed: Feed) -> RuleResult {
    let begun = Moment::latest(client);
    for count in 0.. {
        if client.state != Running || begun.elapsed(client) >= WATCHDOG + PATIENCE {
            break;
        }
        client.request_bytes(&feed(client, count))?;
        // Time passes for a drive in process only while the bench waits.
        client.wait_for(INTERVAL, |_| None::<()>)?;
    }
    equal("state after the watchdog's time", Faulted, client.state)?;
    let it = fault(&client.request(hello(client.session))?)?;
    equal("code and sequence", (FaultCode::Watchdog, last), (it.code, it.sequence))
}

fn feeds() -> impl Iterator<Item = Check> {
    FEEDS.into_iter().map(|(rules, name, feed)| {
        check(rules, name, move |client| {
            start_with(client, WATCHDOG)?;
            for sequence in 1..3 {
                accepted(client, sample(sequence), NONE)?;
            }
            unfed(client, 2, feed)
        })
    })
}

fn frame(message: impl Into<HostMessage>) -> Vec<u8> {
    message.into().frame().to_vec()
}

/// Requests that a running drive accepts or refuses without a change, a few at a time.
fn requests(client: &Client, count: usize) -> Vec<u8> {
    let session = client.session;
    let index = client.parameter(WATCHDOG_US).map_or(0, |it| it.index);
    let live = client.description.parameters.iter().find(|it| it.live);
    let live = live.map_or(SetParameter { index, value: micros(WATCHDOG) }, |it| SetParameter {
        index: it.index,
        value: it.default,
    });
    let requests: [HostMessage; 16] = [
        hello(session).into(),
        other(session),
        GetParameter { index }.into(),
        DescribeParameter { index }.into(),
        DescribeLaw { index: 0 }.into(),
        DescribeSignal { index: 0 }.into(),
        DescribeChoice { parameter: 0, choice: 0 }.into(),
        Subscribe { signals: 0, every: 0 }.into(),
        SetParameter { index, value: micros(Duration::from_secs(30)) }.into(),
        live.into(),
        Arm { session }.into(),
        Arm { session: session ^ 1 }.into(),
        Start { session }.into(),
        Start { session: session ^ 1 }.into(),
        EnterLoader { session: session ^ 1 }.into(),
        Reference { number: 0, reference_rad: 0.0 }.into(),
    ];
    let (first, second) = requests.split_at(requests.len() / 2);
    let part = if count.is_multiple_of(2) { first } else { second };
    part.iter().flat_map(|request| request.frame().to_vec()).collect()
}
