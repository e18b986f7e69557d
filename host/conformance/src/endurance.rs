//! What takes time or many messages: silence without a request, long watchdogs, large counts.

use std::time::{Duration, Instant};

use lashloop_protocol::DriveMessage;
use lashloop_protocol::enums::{ParameterValue, State, TorqueFlags};
use lashloop_protocol::message::{GetParameter, Stop};
use lashloop_protocol::parameter_names::WATCHDOG_US;

use super::answers::{counted, line_report, sample};
use super::assertion::{Failure, RuleResult, equal, expect, names, skip};
use super::check::{Check, check};
use super::client::Client;
use super::exchanges::BURST;
use super::reactions::{accepted, first_sample};

/// Time for which nothing may be sent, and in `Faulted`.
const QUIET: Duration = Duration::from_millis(30);
const QUIET_IN_FAULTED: Duration = Duration::from_secs(1);
/// Watchdogs whose product with 1000 ns, or with the cycles of a processor of 168, 200, 240 or 480 MHz, exceeds 32 bits by next to
/// nothing, and the longest one of every drive.
const LONG_WATCHDOGS_US: [u32; 6] = [4_294_968, 25_565_282, 21_474_837, 17_895_698, 8_947_849, 30_000_000];
/// Silence much shorter than these.
const SILENCE: Duration = Duration::from_millis(15);
/// Time over which device time is measured.
const PACE: Duration = Duration::from_millis(150);
/// Most of it that may be missing or too much, as a fraction, and a coarse clock's on top. The clock of an emulator on a busy
/// machine stands still at times.
const MISSING: f64 = 0.9;
const TOLERANCE: f64 = 0.1;
const TICK: Duration = Duration::from_millis(11);
/// More messages and damaged frames than 16 bits count.
const MANY: usize = 66_000;
/// Writes after which the time of all is estimated, and the most that it may be.
const PROBE: usize = 8;
const MOST_TIME: Duration = Duration::from_millis(2_500);
/// A damaged frame, as short as one can be.
const DAMAGED: [u8; 2] = [1, 0];

pub(super) fn checks() -> Vec<Check> {
    vec![
        check("R4.2 R8.3", "without a request nothing but a Log is sent in any state", |client| {
            State::ALL.iter().try_for_each(|state| quiet(client, *state))
        }),
        check("R4.18 R4.19 R8.5", "device time passes as the time of the bench does", pace),
        check("R8.5 R8.7 R8.10", "a long watchdog does not trip early", long_watchdogs),
        check("R2.7 R4.15", "more than 65536 messages and damaged frames are counted", many),
    ]
}

fn quiet(client: &mut Client, state: State) -> RuleResult {
    client.reset()?;
    client.enter(state)?;
    if state == State::Running {
        first_sample(client)?;
    }
    let limit = if state == State::Faulted { QUIET_IN_FAULTED } else { QUIET };
    let unasked =
        client.wait_for(limit, |message| (!matches!(message, DriveMessage::Log(_))).then_some(*message))?;
    equal(&format!("in {state} without a request, message other than a Log"), None, unasked)?;
    client.request_bytes(&[])?;
    equal("state afterwards", state, client.state)
}

/// The time before and after a read, and the device time of its answer.
fn clocks(client: &mut Client) -> Result<([Instant; 2], Option<u32>), Failure> {
    let before = client.line.now();
    client.request(GetParameter { index: 0 })?;
    Ok(([before, client.line.now()], client.arrivals.device_us))
}

fn pace(client: &mut Client) -> RuleResult {
    let ([before, after], first_us) = clocks(client)?;
    client.wait_for(PACE, |_| None::<()>)?;
    let ([later, latest], last_us) = clocks(client)?;
    let (Some(first_us), Some(last_us)) = (first_us, last_us) else {
        return skip("the drive has no device time");
    };
    let passed = Duration::from_micros(last_us.wrapping_sub(first_us).into());
    let most = latest.saturating_duration_since(before).mul_f64(1.0 + TOLERANCE) + TICK;
    let least = later.saturating_duration_since(after).mul_f64(1.0 - MISSING).saturating_sub(TICK);
    expect(
        (least..=most).contains(&passed),
        format!("between two reads {} to {} us of device time", least.as_micros(), most.as_micros()),
        format!("{} us", passed.as_micros()),
    )
}

fn long_watchdogs(client: &mut Client) -> RuleResult {
    for watchdog_us in LONG_WATCHDOGS_US {
        client.reset()?;
        client.running(&[(WATCHDOG_US, ParameterValue::U32(watchdog_us))])?;
        first_sample(client)?;
        client.wait_for(SILENCE, |_| None::<()>)?;
        let answers = client.request(sample(1))?;
        let silence_ms = SILENCE.as_millis();
        let what = format!("watchdog of {watchdog_us} us, to a sample after {silence_ms} ms");
        equal(&what, vec!["TorqueAnswer"], names(&answers))?;
        equal(&what, State::Running, client.state)?;
        accepted(client, sample(2), TorqueFlags::empty())?;
    }
    Ok(())
}

/// In `Idle` the counts of a run go on.
fn many(client: &mut Client) -> RuleResult {
    client.running(&[])?;
    client.request(Stop {})?;
    let reads = [GetParameter { index: 0 }.into(); BURST];
    let started = client.line.now();
    let writes = MANY / (BURST + 1) + 1;
    for write in 1..=writes {
        let answers = client.burst(&reads)?;
        equal("answers to reads", BURST, answers.len())?;
        let took = client.line.now().saturating_duration_since(started);
        if write == PROBE && took > MOST_TIME.mul_f64(PROBE as f64 / writes as f64) {
            return skip("not judged: this line is too slow");
        }
    }
    client.send_bytes(&DAMAGED.repeat(MANY))?;
    // The markers after Start and Stop, both Stops, and the reads with their markers.
    let messages = 4 + writes * (BURST + 1);
    let counts = line_report(&client.request(Stop {})?)?;
    equal("line report", counted(messages as u32, MANY as u32, 0), counts)
}
