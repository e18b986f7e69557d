//! The scope: signals around an event, at the rate of the loop, read after it.

use lashloop_firmware::Laws;
use lashloop_firmware::law::LawSet;
use lashloop_protocol::enums::{CaptureTrigger, FaultCode, Outcome, ParameterValue, State};
use lashloop_protocol::message::{
    Arm, Capture, CaptureRows, ClearFault, EmergencyStop, Hello, ReadCapture, Reset, Start, Stop, Subscribe,
};
use lashloop_protocol::{DriveMessage, HostMessage};

use crate::host::{HELLO, Host, SESSION};
use crate::pin_host::PinHost;

/// The signals `requested_torque_nm` and `measured_twist_rad`.
const TORQUE: u8 = 0;
const TWIST: u8 = 3;

/// Around the step at which the twist passes 0.01 rad upwards.
const AT_TWIST: Capture = Capture {
    signals: 1 << TORQUE | 1 << TWIST,
    every: 1,
    before: 4,
    trigger: CaptureTrigger::Rising,
    trigger_signal: TWIST,
    level: 0.01,
};
/// Four signals, from the first step on.
const AT_ONCE: Capture = Capture {
    signals: 0b1111,
    every: 1,
    before: 0,
    trigger: CaptureTrigger::Now,
    trigger_signal: TORQUE,
    level: 0.0,
};

/// The complete capture: number of the row of the event, and all rows.
fn read(send: &mut dyn FnMut(HostMessage) -> Vec<DriveMessage>, width: usize) -> (u16, Vec<Vec<f32>>) {
    let (mut event, mut rows) = (0, Vec::new());
    loop {
        let first = rows.len() as u16;
        match send(ReadCapture { first }.into())[..] {
            [DriveMessage::CaptureRows(CaptureRows { first: of, event: at, values })] => {
                assert_eq!(of, first);
                event = at;
                rows.extend(values.as_slice().chunks(width).map(<[f32]>::to_vec));
            }
            [DriveMessage::CommandResult(it)] if it.outcome == Outcome::UnknownIndex => {
                assert_eq!(it.detail as usize, rows.len(), "the number of rows");
                return (event, rows);
            }
            ref other => panic!("{other:?}"),
        }
    }
}

fn rows_of(host: &mut Host, width: usize) -> (u16, Vec<Vec<f32>>) {
    read(&mut |message| host.send(message), width)
}

fn twists(host: &mut Host) -> (u16, Vec<f32>) {
    let (event, rows) = rows_of(host, 2);
    (event, rows.into_iter().map(|row| row[1]).collect())
}

/// Counts of the motor for this twist.
fn counts(twist_rad: f64) -> i64 {
    (twist_rad * 131_072.0 / std::f64::consts::TAU) as i64
}

/// A step at each twist, the load at rest; the telemetry of each.
fn turn(host: &mut Host, from: u16, twists_rad: impl IntoIterator<Item = f64>) -> Vec<Vec<f32>> {
    let steps = (from..).zip(twists_rad);
    let answers = steps.flat_map(|(sequence, twist_rad)| host.sample(sequence, counts(twist_rad), 0));
    let telemetry = answers.filter_map(|answer| match answer {
        DriveMessage::Telemetry(it) => Some(it.values.as_slice().to_vec()),
        _ => None,
    });
    telemetry.collect()
}

/// A twist that rises by 1 mrad a step.
fn ramp(steps: std::ops::Range<u16>) -> impl Iterator<Item = f64> {
    steps.map(|step| 1e-3 * f64::from(step))
}

fn bits(rows: &[Vec<f32>]) -> Vec<Vec<u32>> {
    rows.iter().map(|row| row.iter().map(|value| value.to_bits()).collect()).collect()
}

fn start(host: &mut Host) {
    assert_eq!(host.command(Arm { session: SESSION }).0, Outcome::Accepted);
    assert_eq!(host.command(Start { session: SESSION }).0, Outcome::Accepted);
}

#[test]
fn the_rows_are_the_telemetry_of_every_step_bit_for_bit() {
    let mut host = Host::running(&[]);
    host.send(Subscribe { signals: AT_TWIST.signals, every: 1 });
    assert_eq!(host.command(AT_TWIST), (Outcome::Accepted, State::Running));
    let telemetry = turn(&mut host, 0, ramp(0..600));
    let (event, rows) = rows_of(&mut host, 2);
    assert_eq!((event, rows.len()), (4, 512));
    let at = telemetry.iter().position(|row| row[1] >= AT_TWIST.level).expect("the level is passed");
    assert!(telemetry[at - 1][1] < AT_TWIST.level && at > 4);
    assert_eq!(bits(&rows), bits(&telemetry[at - 4..at - 4 + 512]));
}

#[test]
fn fewer_signals_take_more_rows_of_the_same_memory() {
    for (signals, want) in [(0b1, 1024), (0b11, 512), (0b111, 341), (0b1111, 256)] {
        let width = u32::count_ones(signals) as usize;
        let mut host = Host::running(&[]);
        host.send(Capture { signals, ..AT_ONCE });
        turn(&mut host, 0, ramp(0..want - 1));
        assert_eq!(host.refusal(ReadCapture { first: 0 }).1, 2, "one row is missing");
        turn(&mut host, want - 1, ramp(want - 1..want));
        assert_eq!(rows_of(&mut host, width).1.len(), usize::from(want));
        let before = Capture { signals, before: want, ..AT_ONCE };
        assert_eq!(host.command(before).0, Outcome::OutOfRange, "all rows but that of the event");
        assert_eq!(host.command(Capture { before: want - 1, ..before }).0, Outcome::Accepted);
    }
}

/// The ring of the rows before the event wraps around the memory many times.
#[test]
fn a_capture_has_the_rows_before_a_late_event() {
    for before in [0, 1, 300, 510, 511] {
        let mut host = Host::running(&[]);
        host.send(Capture { before, ..AT_TWIST });
        let rest = (0..2000).map(|step| -1e-4 * f64::from(step % 100));
        turn(&mut host, 0, rest.chain([0.02; 600]));
        let (event, twists) = twists(&mut host);
        assert_eq!((event, twists.len()), (before, 512));
        let want = (2000 - before..2000 - before + 512)
            .map(|step| if step < 2000 { -1e-4 * f64::from(step % 100) } else { 0.02 });
        for (have, want) in twists.into_iter().zip(want) {
            assert!((f64::from(have) - want).abs() < 1e-4, "{have} rad, want {want} rad");
        }
    }
}

#[test]
fn an_early_event_has_fewer_rows_before_it_and_more_after_it() {
    let mut host = Host::running(&[]);
    host.send(Capture { before: 100, ..AT_TWIST });
    turn(&mut host, 0, ramp(0..600));
    let (event, twists) = twists(&mut host);
    assert!((9..13).contains(&event), "all rows since the request: {event}");
    assert_eq!(twists.len(), 512);
}

#[test]
fn a_trigger_at_once_waits_for_the_rows_before_it() {
    let mut host = Host::running(&[]);
    host.send(Capture { before: 3, ..AT_ONCE });
    turn(&mut host, 0, ramp(0..3));
    assert_eq!(host.refusal(ReadCapture { first: 0 }), (Outcome::NotCaptured, 1, State::Running));
    turn(&mut host, 3, ramp(3..4));
    assert_eq!(host.refusal(ReadCapture { first: 0 }), (Outcome::NotCaptured, 2, State::Running));
    host.send(Stop {});
    let (event, rows) = rows_of(&mut host, 4);
    assert_eq!((event, rows.len()), (3, 4));
}

#[test]
fn only_a_passage_of_the_level_in_its_direction_is_the_event() {
    let (below, above) = (0.005, 0.02);
    for (trigger, twists_rad, is_event) in [
        (CaptureTrigger::Rising, [below, above], true),
        (CaptureTrigger::Rising, [above, above], false),
        (CaptureTrigger::Rising, [above, below], false),
        (CaptureTrigger::Falling, [above, below], true),
        (CaptureTrigger::Falling, [below, below], false),
        (CaptureTrigger::Falling, [below, above], false),
    ] {
        let mut host = Host::running(&[]);
        host.send(Capture { trigger, ..AT_TWIST });
        turn(&mut host, 0, twists_rad);
        let want = if is_event { 2 } else { 1 };
        let refusal = host.refusal(ReadCapture { first: 0 });
        assert_eq!(refusal, (Outcome::NotCaptured, want, State::Running), "{trigger} {twists_rad:?}");
    }
}

#[test]
fn a_capture_has_a_row_every_n_th_step() {
    let mut host = Host::running(&[]);
    host.send(Subscribe { signals: AT_ONCE.signals, every: 3 });
    host.send(Capture { every: 3, ..AT_ONCE });
    let telemetry = turn(&mut host, 0, ramp(0..32));
    host.send(Stop {});
    let (_, rows) = rows_of(&mut host, 4);
    assert_eq!(rows.len(), 11);
    assert_eq!(bits(&rows), bits(&telemetry));
}

#[test]
fn every_run_has_a_row_of_its_first_step() {
    let mut host = Host::idle();
    host.send(Capture { every: 5, before: 10, ..AT_ONCE });
    for (steps, event_is_there) in [(7, false), (7, false), (36, true)] {
        start(&mut host);
        turn(&mut host, 0, ramp(0..steps));
        host.send(Stop {});
        let is_there = matches!(host.send(ReadCapture { first: 0 })[..], [DriveMessage::CaptureRows(_)]);
        assert_eq!(is_there, event_is_there);
    }
    let twists: Vec<_> = rows_of(&mut host, 4).1.iter().map(|row| (1e3 * row[3]).round()).collect();
    assert_eq!(twists, [0.0, 5.0, 0.0, 5.0, 0.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0]);
}

#[test]
fn a_capture_waits_from_run_to_run_and_ends_with_the_run_of_its_event() {
    let mut host = Host::idle();
    host.send(AT_TWIST);
    for _ in 0..2 {
        start(&mut host);
        turn(&mut host, 0, ramp(0..5));
        host.send(Stop {});
        assert_eq!(host.refusal(ReadCapture { first: 0 }), (Outcome::NotCaptured, 1, State::Idle));
    }
    start(&mut host);
    turn(&mut host, 0, ramp(0..20));
    assert_eq!(host.refusal(ReadCapture { first: 0 }), (Outcome::NotCaptured, 2, State::Running));
    host.send(Stop {});
    let (event, rows) = twists(&mut host);
    assert!(event == 4 && (11..15).contains(&rows.len()), "{} rows", rows.len());
    start(&mut host);
    turn(&mut host, 0, ramp(0..20));
    assert_eq!(twists(&mut host), (event, rows), "a later run adds nothing");
}

#[test]
fn a_session_that_ends_the_run_ends_the_recording() {
    let mut host = Host::running(&[]);
    host.send(AT_ONCE);
    turn(&mut host, 0, ramp(0..7));
    host.send(Hello { session: SESSION + 1, ..HELLO });
    host.send(HELLO);
    start(&mut host);
    turn(&mut host, 0, ramp(0..7));
    assert_eq!(rows_of(&mut host, 4).1.len(), 7);
}

#[test]
fn a_fault_between_two_steps_comes_after_the_last_row() {
    let mut host = Host::running(&[]);
    host.send(Capture { trigger: CaptureTrigger::Fault, ..AT_TWIST });
    turn(&mut host, 0, ramp(0..20));
    host.send(EmergencyStop {});
    assert_eq!(host.drive.state(), State::Faulted);
    let (event, rows) = twists(&mut host);
    assert_eq!((event, rows.len()), (4, 4), "no row at the event");
    assert!((rows[3] - 0.019).abs() < 1e-4, "the last step: {} rad", rows[3]);
    host.send(ClearFault {});
    assert_eq!(twists(&mut host), (event, rows), "after the fault was cleared too");
}

#[test]
fn a_step_that_is_rejected_before_the_law_has_no_row() {
    let mut host = Host::running(&[]);
    host.send(Capture { trigger: CaptureTrigger::Fault, ..AT_TWIST });
    turn(&mut host, 0, ramp(0..20).chain([2.0]));
    assert_eq!(host.drive.state(), State::Faulted, "an encoder that jumps");
    let (event, rows) = twists(&mut host);
    assert_eq!((event, rows.len()), (4, 4));
}

#[test]
fn a_fault_before_the_first_step_is_an_event_without_rows() {
    let mut host = Host::running(&[]);
    host.send(Capture { trigger: CaptureTrigger::Fault, ..AT_TWIST });
    host.send(EmergencyStop {});
    assert_eq!(host.refusal(ReadCapture { first: 0 }), (Outcome::UnknownIndex, 0, State::Faulted));
}

#[test]
fn a_fault_ends_a_recording() {
    let mut host = Host::running(&[]);
    host.send(AT_ONCE);
    turn(&mut host, 0, ramp(0..20));
    host.send(EmergencyStop {});
    let (event, rows) = rows_of(&mut host, 4);
    assert_eq!((event, rows.len()), (0, 20));
}

#[test]
fn the_row_of_a_fault_is_that_of_the_step_that_caused_it() {
    let mut host = PinHost::running(&[("twist_limit_rad", ParameterValue::F32(0.5))]);
    host.send(Capture { before: 10, trigger: CaptureTrigger::Fault, ..AT_TWIST });
    for twist_rad in [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6] {
        host.refer(0.0);
        host.turn(counts(twist_rad), 0);
        if host.tick().iter().any(|answer| matches!(answer, DriveMessage::FaultReport(_))) {
            break;
        }
    }
    let (event, rows) = read(&mut |message| host.send(message), 2);
    assert_eq!(usize::from(event), rows.len() - 1);
    let twists: Vec<_> = rows.iter().map(|row| (10.0 * row[1]).round()).collect();
    assert_eq!(twists, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
}

#[test]
fn reset_and_a_capture_of_nothing_drop_the_capture() {
    for reset in [true, false] {
        let mut host = Host::running(&[]);
        host.send(AT_ONCE);
        turn(&mut host, 0, ramp(0..4));
        host.send(Stop {});
        assert_eq!(rows_of(&mut host, 4).1.len(), 4);
        if reset {
            host.send(Reset {});
        } else {
            assert_eq!(
                host.command(Capture { signals: 0, every: 0, ..AT_ONCE }),
                (Outcome::Accepted, State::Idle)
            );
        }
        assert_eq!(host.refusal(ReadCapture { first: 0 }).1, 0);
    }
}

#[test]
fn a_drive_takes_a_capture_in_idle_armed_and_running_only() {
    let mut armed = Host::idle();
    armed.send(Arm { session: SESSION });
    let mut faulted = Host::idle();
    faulted.send(EmergencyStop {});
    for (mut host, want) in [
        (Host::new(), (Outcome::WrongState, State::Boot)),
        (Host::idle(), (Outcome::Accepted, State::Idle)),
        (armed, (Outcome::Accepted, State::Armed)),
        (Host::running(&[]), (Outcome::Accepted, State::Running)),
        (faulted, (Outcome::WrongState, State::Faulted)),
    ] {
        assert_eq!(host.command(AT_TWIST), want);
    }
}

#[test]
fn a_refused_capture_changes_nothing() {
    let mut host = Host::running(&[]);
    host.send(AT_ONCE);
    let beyond = 1 << Laws::SIGNALS.len();
    let unknown = CaptureTrigger::from_byte(99).expect("a value without a name");
    let [rising, falling] =
        [CaptureTrigger::Rising, CaptureTrigger::Falling].map(|trigger| Capture { trigger, ..AT_ONCE });
    for (capture, want) in [
        (Capture { signals: beyond | 1, ..AT_ONCE }, Outcome::UnknownIndex),
        (Capture { signals: 0b1_1111, ..AT_ONCE }, Outcome::OutOfRange),
        (Capture { every: 0, ..AT_ONCE }, Outcome::OutOfRange),
        (Capture { before: 256, ..AT_ONCE }, Outcome::OutOfRange),
        (Capture { trigger_signal: 4, ..rising }, Outcome::UnknownIndex),
        (Capture { trigger_signal: 32, ..falling }, Outcome::UnknownIndex),
        (Capture { level: f32::NAN, ..rising }, Outcome::OutOfRange),
        (Capture { level: f32::INFINITY, ..falling }, Outcome::OutOfRange),
        (Capture { trigger: unknown, ..AT_ONCE }, Outcome::OutOfRange),
    ] {
        assert_eq!(host.refusal(capture), (want, 0, State::Running), "{capture:?}");
    }
    turn(&mut host, 0, ramp(0..300));
    assert_eq!(rows_of(&mut host, 4).1.len(), 256);
}

#[test]
fn a_signal_of_another_law_is_refused_and_checked_by_arm() {
    let open_loop = ("controller", ParameterValue::U32(5));
    let error = Host::<Laws>::signal("load_error_rad");
    let index = error.trailing_zeros();
    let capture = Capture { signals: error, trigger_signal: index as u8, ..AT_ONCE };
    let mut armed = Host::idle();
    armed.set(open_loop.0, open_loop.1);
    let idle = armed.refusal(capture);
    assert_eq!(idle, (Outcome::SignalOfOtherLaw, index, State::Idle));
    armed.send(Arm { session: SESSION });
    let running = Host::running(&[open_loop]);
    for (mut host, state) in [(armed, State::Armed), (running, State::Running)] {
        assert_eq!(host.refusal(capture), (Outcome::SignalOfOtherLaw, index, state));
    }
    let mut host = Host::idle();
    assert_eq!(host.command(capture), (Outcome::Accepted, State::Idle));
    host.set(open_loop.0, open_loop.1);
    let refusal = host.refusal(Arm { session: SESSION });
    assert_eq!(refusal, (Outcome::SignalOfOtherLaw, index, State::Idle));
    host.set(open_loop.0, ParameterValue::U32(0));
    assert_eq!(host.command(Arm { session: SESSION }), (Outcome::Accepted, State::Armed));
}

#[test]
fn a_message_has_whole_rows() {
    for (signals, rows) in [(0b1, 13), (0b11, 6), (0b111, 4), (0b1111, 3)] {
        let mut host = Host::running(&[]);
        host.send(Capture { signals, ..AT_ONCE });
        turn(&mut host, 0, ramp(0..14));
        host.send(Stop {});
        let [DriveMessage::CaptureRows(it)] = host.send(ReadCapture { first: 0 })[..] else { panic!("rows") };
        assert_eq!(it.values.as_slice().len(), rows * u32::count_ones(signals) as usize);
        let [DriveMessage::CaptureRows(it)] = host.send(ReadCapture { first: 13 })[..] else {
            panic!("the last row")
        };
        assert_eq!(it.values.as_slice().len(), u32::count_ones(signals) as usize);
        assert_eq!(host.refusal(ReadCapture { first: 14 }), (Outcome::UnknownIndex, 14, State::Idle));
    }
}

#[test]
fn the_watchdog_is_a_fault_too() {
    let mut host = Host::running(&[]);
    host.send(Capture { trigger: CaptureTrigger::Fault, ..AT_TWIST });
    turn(&mut host, 0, ramp(0..2));
    host.advance(std::time::Duration::from_secs(10));
    assert!(
        host.take_output()
            .iter()
            .any(|answer| matches!(answer, DriveMessage::FaultReport(it) if it.code == FaultCode::Watchdog))
    );
    assert_eq!(twists(&mut host).0, 2);
}
