//! Captures: what is refused, which rows a drive records, and how they are read.

use super::super::exchanges::refused;
use super::super::telemetry::subscription::{accepted as subscribed, law_signals};
use super::offered::{UNNAMED, needs};
use crate::prelude::checks::*;

/// Most signals of a capture.
const MOST: usize = 4;
/// References of a run, with the mechanics at rest. A law's request has its extremes in the middle.
const REFERENCES_RAD: [f32; 15] =
    [0.5, 0.25, 0.75, 0.5, -0.5, 1.25, 0.75, -1.5, -0.25, 0.5, 0.25, 0.75, 0.5, 0.25, 0.0];
/// Values of a row in telemetry or capture, as bits.
type Row = Vec<u32>;

pub(super) fn checks() -> Vec<Check> {
    vec![
        check("R22.2", "a Capture is refused for its first reason in the order of the table", refusals),
        check(
            "R22.3 R22.11",
            "a capture is kept until the next one that is accepted, and no longer than Reset",
            kept,
        ),
        check(
            "R22.4 R22.7 R22.8 R22.9 R22.10",
            "the rows of a capture have the values of the telemetry",
            rows,
        ),
        check("R22.5 R22.6", "a capture records around the first row beyond the level", at_level),
        check("R22.5 R22.6", "a capture records up to a fault", up_to_fault),
    ]
}

/// A capture that needs no event.
pub(super) fn at_once(signals: u32, every: u16, before: u16) -> Capture {
    let trigger_signal = signals.trailing_zeros().min(31) as u8;
    Capture { signals, every, before, trigger: CaptureTrigger::Now, trigger_signal, level: 0.0 }
}

/// Indices of up to four signals of the law in force.
fn signals(client: &Client) -> Result<Vec<u8>, Failure> {
    needs(client, Capabilities::CAPTURE, "the drive captures no signals")?;
    let mut signals = law_signals(client, client.default_law());
    signals.truncate(MOST);
    if signals.is_empty() { skip("the law in force has no signal") } else { Ok(signals) }
}

fn mask(signals: &[u8]) -> u32 {
    signals.iter().fold(0, |all, index| all | 1 << index)
}

fn refusals(client: &mut Client) -> RuleResult {
    let known = signals(client)?;
    let good = at_once(mask(&known), 1, 0);
    let law = client.default_law();
    let lacked = client.description.signals.iter().find(|it| !it.laws.contains(law)).map(|it| it.index);
    let unknown = u32::MAX.checked_shl(client.identity.signal_count.into()).unwrap_or(0);
    let all = law_signals(client, law);
    let level = |trigger, trigger_signal, level| Capture { trigger, trigger_signal, level, ..good };
    let (rising, falling) = (CaptureTrigger::Rising, CaptureTrigger::Falling);
    let mut cases = vec![
        (Capture { every: 0, ..good }, OutOfRange, 0),
        (Capture { before: u16::MAX, ..good }, OutOfRange, 0),
        (level(CaptureTrigger::from_byte(UNNAMED).unwrap_or(rising), known[0], 0.0), OutOfRange, 0),
        (level(rising, 31, 0.0), UnknownIndex, 0),
        (level(falling, u8::MAX, 0.0), UnknownIndex, 0),
        (level(rising, known[0], f32::NAN), OutOfRange, 0),
        (level(falling, known[0], f32::INFINITY), OutOfRange, 0),
    ];
    if unknown != 0 {
        let bits = [unknown, 1 << 31, u32::MAX].into_iter().filter(|bits| bits & unknown != 0);
        cases.extend(bits.map(|signals| (Capture { signals, every: 0, ..good }, UnknownIndex, 0)));
    }
    if all.len() > MOST {
        cases.push((Capture { signals: mask(&all[..=MOST]), ..good }, OutOfRange, 0));
    }
    if let Some(lacked) = lacked {
        cases.push((at_once(1 << lacked | mask(&known[..1]), 1, 0), SignalOfOtherLaw, lacked.into()));
    }
    client.in_states(State::ALL, |client, state| {
        let takes = matches!(state, Idle | Armed | Running);
        let each = cases.iter().map(|(capture, outcome, detail)| {
            if takes {
                refused(*capture, *outcome, state, *detail)
            } else {
                result(*capture, WrongState, state)
            }
        });
        let mut each: Vec<Exchange> = each.collect();
        let (outcome, none) = if takes { (Accepted, Accepted) } else { (WrongState, WrongState) };
        each.push(not_captured(0, state));
        each.push(result(good, outcome, state));
        each.push(not_captured(u32::from(takes), state));
        each.push(result(Capture { signals: 0, ..good }, none, state));
        each.push(not_captured(0, state));
        client.exchange(&format!("in {state}"), &each)
    })
}

/// A `ReadCapture` of what isn't complete.
fn not_captured(detail: u32, state: State) -> Exchange {
    refused(ReadCapture { first: 0 }, Outcome::NotCaptured, state, detail)
}

/// Prepares a capture in `Idle`, with the telemetry of its signals.
fn prepared(client: &mut Client, capture: Capture) -> RuleResult {
    client.reset()?;
    client.idle()?;
    subscribed(client, capture.signals, 1)?;
    let answers = client.request(capture)?;
    match outcome::<Capture>(&answers)? {
        OutOfRange => skip("not run: the drive holds too few rows"),
        other => equal("to Capture:", Accepted, other),
    }
}

/// The values of the telemetry of a sample.
fn step(client: &mut Client, sequence: u16) -> Result<Row, Failure> {
    let reference_rad = REFERENCES_RAD[usize::from(sequence) % REFERENCES_RAD.len()];
    let answers = client.request_to(EncoderSample { reference_rad, ..sample(sequence) }, "Telemetry")?;
    Ok(bits(telemetry(&answers)?.values.as_slice()))
}

fn bits(values: &[f32]) -> Row {
    values.iter().map(|value| value.to_bits()).collect()
}

/// All rows of a complete capture of this many signals, and the number of the row of the event.
fn read(client: &mut Client, width: usize) -> Result<(Vec<Row>, usize), Failure> {
    let last =
        of_kinds("to ReadCapture", &["CommandResult"], client.request(ReadCapture { first: u16::MAX })?)?;
    let it = command_result(&ReadCapture::LAYOUT, &last)?;
    equal("to ReadCapture beyond the last row: outcome", UnknownIndex, it.outcome)?;
    let count = it.detail as usize;
    let fit = MAX_TELEMETRY_VALUES / width;
    let (mut rows, mut event) = (Vec::new(), None);
    while rows.len() < count {
        let first = rows.len() as u16;
        let wanted = fit.min(count - rows.len());
        let answers = of_kinds("to ReadCapture", &["CaptureRows"], client.request(ReadCapture { first })?)?;
        let it: CaptureRows = find("CaptureRows", &answers, of)?;
        let values = it.values.as_slice();
        let event = *event.get_or_insert(it.event);
        let what = format!("to ReadCapture from row {first} of {count}: first, event, values");
        equal(&what, (first, event, wanted * width), (it.first, it.event, values.len()))?;
        rows.extend(values.chunks(width).map(bits));
    }
    let beyond = refused(ReadCapture { first: it.detail as u16 }, UnknownIndex, client.state, it.detail);
    client.exchange("after the last row", &[beyond])?;
    Ok((rows, event.unwrap_or_default().into()))
}

/// Requires these rows, and of those after the event as many as the drive holds.
fn same_rows(client: &mut Client, wanted: &[Row], event: usize) -> RuleResult {
    let (rows, got) = read(client, wanted.first().map_or(1, Vec::len))?;
    equal("row of the event", event, got)?;
    let held = rows.len().min(wanted.len()).max(event.min(wanted.len()));
    equal("rows:", &wanted[..held], &rows)
}

fn rows(client: &mut Client) -> RuleResult {
    let known = signals(client)?;
    for (width, every, before) in [(1, 1, 0), (4, 2, 3), (3, 3, 0), (2, 1, 5)] {
        let known = &known[..known.len().min(width)];
        prepared(client, at_once(mask(known), every, before))?;
        client.exchange("before the run", &[not_captured(1, Idle)])?;
        client.running(&[])?;
        let mut all = Vec::new();
        for sequence in 0..REFERENCES_RAD.len() as u16 {
            let row = step(client, sequence)?;
            if sequence.is_multiple_of(every) {
                all.push(row);
            }
            let answers = client.request(ReadCapture { first: 0 })?;
            if let [DriveMessage::CommandResult(it)] = answers[..] {
                let detail = if all.len() > usize::from(before) { 2 } else { 1 };
                let wanted = (Outcome::NotCaptured, Running, detail);
                let what =
                    format!("to ReadCapture after row {} of the run: outcome, state, detail", all.len());
                equal(&what, wanted, (it.outcome, it.state, it.detail))?;
            }
        }
        client.request(Stop {})?;
        same_rows(client, &all, before.into())?;
    }
    Ok(())
}

fn at_level(client: &mut Client) -> RuleResult {
    let known = signals(client)?;
    prepared(client, at_once(mask(&known), 1, 0))?;
    client.running(&[])?;
    let values = (0..REFERENCES_RAD.len() as u16).map(|sequence| step(client, sequence));
    let values = values.collect::<Result<Vec<_>, _>>()?;
    let mut is_tested = false;
    for (trigger, sign) in [(CaptureTrigger::Rising, 1.0), (CaptureTrigger::Falling, -1.0)] {
        // Upwards, whichever the trigger.
        let height = |row: &Row, place: usize| sign * f32::from_bits(row[place]);
        let highest = |place: usize| {
            let heights = values.iter().map(|row| height(row, place));
            let most = heights.clone().fold(f32::MIN, f32::max);
            let step = heights.clone().position(|it| it == most)?;
            (step > 2).then_some((place, most))
        };
        let Some((place, most)) = (0..known.len()).find_map(highest) else { continue };
        is_tested = true;
        let (trigger_signal, level, before) = (known[place], sign * most, 2);
        let capture = at_once(mask(&known), 1, before);
        prepared(client, Capture { trigger, trigger_signal, level, ..capture })?;
        client.running(&[])?;
        let all = (0..REFERENCES_RAD.len() as u16).map(|sequence| step(client, sequence));
        let all = all.collect::<Result<Vec<_>, _>>()?;
        client.request(Stop {})?;
        // Equal samples need not have equal signals.
        let is_event = |pair: &[Row]| height(&pair[0], place) < most && height(&pair[1], place) >= most;
        let Some(event) = all.windows(2).position(is_event).map(|it| it + 1) else {
            client.exchange("after a run without the event", &[not_captured(1, Idle)])?;
            continue;
        };
        let first = event.saturating_sub(before.into());
        same_rows(client, &all[first..], event - first)?;
    }
    if is_tested { Ok(()) } else { skip("no signal of the law has its extreme within the run") }
}

/// The sample of the fault may give a row too.
fn up_to_fault(client: &mut Client) -> RuleResult {
    let known = signals(client)?;
    let before = 2;
    let capture = at_once(mask(&known), 1, before);
    prepared(client, Capture { trigger: CaptureTrigger::Fault, ..capture })?;
    client.running(&[])?;
    let all = (0..5).map(|sequence| step(client, sequence)).collect::<Result<Vec<_>, _>>()?;
    client.exchange("before the fault", &[not_captured(1, Running)])?;
    fault(&client.request(EncoderSample { reference_rad: f32::NAN, ..sample(5) })?)?;
    let (mut rows, event) = read(client, known.len())?;
    rows.truncate(before.into());
    equal("rows before the fault:", &all[all.len() - usize::from(before)..], &rows)?;
    equal("row of the event", usize::from(before), event)
}

fn kept(client: &mut Client) -> RuleResult {
    let known = signals(client)?;
    let good = at_once(mask(&known), 1, 1);
    let session = client.session;
    let complete = |client: &mut Client| {
        prepared(client, good)?;
        client.running(&[])?;
        let all = (0..4).map(|sequence| step(client, sequence)).collect::<Result<Vec<_>, _>>()?;
        client.request(Stop {})?;
        same_rows(client, &all, 1).map(|()| all)
    };
    let all = complete(client)?;
    client.exchange("in Idle", &[result(Capture { every: 0, ..good }, OutOfRange, Idle)])?;
    same_rows(client, &all, 1)?;
    client.arm_and_start()?;
    step(client, 0)?;
    same_rows(client, &all, 1)?;
    client.request(EmergencyStop {})?;
    client.exchange("in Faulted", &[result(good, WrongState, Faulted)])?;
    same_rows(client, &all, 1)?;
    client.request(ClearFault {})?;
    client.handshake(session ^ 1)?;
    client.handshake(session)?;
    same_rows(client, &all, 1)?;
    let none = result(Capture { signals: 0, ..good }, Accepted, Idle);
    client.exchange("in Idle", &[none, not_captured(0, Idle)])?;
    complete(client)?;
    client.exchange("in Idle", &[result(good, Accepted, Idle), not_captured(1, Idle)])?;
    complete(client)?;
    client.reset()?;
    client.exchange("after Reset", &[not_captured(0, Boot)])
}
