//! What takes time or many messages: silence without a request, long watchdogs, large counts.

use super::receiver::framed;
use super::safety::in_time;
use crate::prelude::checks::*;

/// Time for which nothing may be sent, and in `Faulted`.
const QUIET: Duration = Duration::from_millis(30);
const QUIET_IN_FAULTED: Duration = Duration::from_secs(1);
/// Watchdogs that exceed 16 and 24 bits, and 16 bits of 250 us, by 2 ms; those whose product with 1000 ns, or with the cycles
/// of a processor of 168, 200, 240 or 480 MHz, exceeds 32 bits by next to nothing; and the longest one of every drive.
const LONG_WATCHDOGS_US: [u32; 9] =
    [67_536, 16_779_216, 16_386_000, 4_294_968, 25_565_282, 21_474_837, 17_895_698, 8_947_849, 30_000_000];
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
/// Parts in which they are sent, those that may take longer than the others, and the most time for all.
const PARTS: u32 = 132;
const SLOW_PARTS: u32 = 8;
const MOST_TIME: Duration = Duration::from_millis(2_500);
/// The body of an unknown request without an answer, a damaged frame, and the body of a refused one, as short as they can be.
const UNANSWERED: [u8; 1] = [0x1c];
const DAMAGED: [u8; 2] = [1, 0];
const REFUSED: [u8; 1] = [0x80];

pub(super) fn checks() -> Vec<Check> {
    vec![
        check(
            "R1.1 R4.2 R8.3",
            "on an idle line, and in a pause of a frame, nothing but a Log is sent in any state",
            |client| client.in_states(State::ALL, quiet),
        ),
        check("R4.18 R4.19 R8.5", "device time passes as the time of the bench does", pace),
        in_time(check("R8.5 R8.7 R8.10", "a long watchdog does not trip early", long_watchdogs)),
        check(
            "R2.3 R2.7 R4.15",
            "more than 65536 messages, damaged frames and refused ones are counted",
            many,
        ),
    ]
}

fn quiet(client: &mut Client, state: State) -> RuleResult {
    if state == Running {
        first_sample(client)?;
    }
    no_message(client, state, QUIET)?;
    // A frame has no time to end in.
    let read = client.frame(GetParameter { index: 0 });
    let (first, rest) = read.split_at(read.len() / 2);
    client.send_bytes(first)?;
    no_message(client, state, if state == Faulted { QUIET_IN_FAULTED } else { QUIET })?;
    let answers = client.request_bytes(rest)?;
    equal(&format!("in {state}, to a frame with a pause in it"), vec!["ParameterReport"], names(&answers))?;
    equal("state afterwards", state, client.state)
}

fn no_message(client: &mut Client, state: State, time: Duration) -> RuleResult {
    let unasked = client.wait_for(time, |message| (!is::<Log>(message)).then_some(*message))?;
    equal(&format!("in {state} without a request, message other than a Log"), None, unasked)
}

/// The time before and after a read, and the device time of its answer, the only one.
fn clocks(client: &mut Client) -> Result<([Instant; 2], Option<u32>), Failure> {
    let before = client.line.now();
    client.request_one(GetParameter { index: 0 })?;
    Ok(([before, client.line.now()], client.arrivals.device_us))
}

fn pace(client: &mut Client) -> RuleResult {
    client.running(&[])?;
    first_sample(client)?;
    let ([before, after], first_us) = clocks(client)?;
    client.wait_for(PACE, |_| None::<()>)?;
    let ([later, latest], last_us) = clocks(client)?;
    let (Some(first_us), Some(last_us)) = (first_us, last_us) else {
        return skip("the drive has no device time");
    };
    let passed = Duration::from_micros(last_us.wrapping_sub(first_us).into());
    let most = latest.saturating_duration_since(before).mul_f64(1.0 + TOLERANCE) + TICK;
    let least = later.saturating_duration_since(after).mul_f64(1.0 - MISSING).saturating_sub(TICK);
    let expected = format!("{} to {} of device time between two reads", least.words(), most.words());
    expect((least..=most).contains(&passed), expected, passed)
}

fn long_watchdogs(client: &mut Client) -> RuleResult {
    let count = client.repetitions(LONG_WATCHDOGS_US.len()).max(3);
    for &watchdog_us in &LONG_WATCHDOGS_US[..count] {
        client.reset()?;
        client.running(&[(WATCHDOG_US, U32(watchdog_us))])?;
        first_sample(client)?;
        client.wait_for(SILENCE, |_| None::<()>)?;
        let silence_ms = SILENCE.as_millis();
        let what = format!("watchdog of {watchdog_us} us, to a sample after {silence_ms} ms");
        of_kinds(&what, &["TorqueAnswer"], client.request(sample(1))?)?;
        equal(&what, Running, client.state)?;
        accepted(client, sample(2), NONE)?;
    }
    Ok(())
}

/// In `Idle` the counts of a run go on. An unknown request without an answer is the shortest message.
fn many(client: &mut Client) -> RuleResult {
    if client.repetitions(2) < 2 {
        return skip("not judged: this line is too slow");
    }
    client.running(&[])?;
    client.request(Stop {})?;
    let part = [&framed(&UNANSWERED)[..], &DAMAGED, &framed(&REFUSED)].concat().repeat(MANY / PARTS as usize);
    let started = client.line.now();
    // Of a length that 16 bits don't count, with a request at its end.
    client.send_bytes(&[&vec![0x55; 1 << 16][..], &*HostMessage::from(Stop {}).frame()].concat())?;
    for sent in 1..=PARTS {
        client.send_bytes(&part)?;
        client.request_bytes(&[])?;
        let took = client.line.now().saturating_duration_since(started);
        if took > MOST_TIME * (sent + SLOW_PARTS) / PARTS {
            return skip("not judged: this line is too slow");
        }
    }
    // The markers after Start, Stop and each part, and both Stops.
    let counts = line_report(&client.request(Stop {})?)?;
    equal("line report", counted(MANY as u32 + PARTS + 4, MANY as u32 + 1, MANY as u32), counts)
}
