//! The frame of the battery: what it bears, what it reports, and when it ends.

use std::time::Duration;

use lashloop_conformance::CheckStatus;
use lashloop_protocol::enums::{Capabilities, LogLevel, Outcome, ParameterValue, State, TorqueFlags};
use lashloop_protocol::message::{CommandResult, Log, ParameterDescription, Start, Telemetry, TorqueAnswer};
use lashloop_protocol::text::Text;
use lashloop_protocol::wire::Payload;
use lashloop_protocol::{DriveMessage, Frame, MAX_BODY, Message, Numbered, TelemetryValues, frame};

use crate::altered::{Alteration, Altered, Battery, NEW_FLAG, Passing};

fn whole(it: &Numbered<DriveMessage>) -> Vec<u8> {
    it.message.numbered_frame(it.number).to_vec()
}

/// With another message in its place.
fn instead(it: &Numbered<DriveMessage>, message: impl Into<DriveMessage>) -> Vec<u8> {
    whole(&Numbered { number: it.number, message: message.into() })
}

fn log(device_time_us: Option<u32>) -> Vec<u8> {
    let log = Log { level: LogLevel::Debug, text: Text::new("still alive"), device_time_us };
    DriveMessage::from(log).frame().to_vec()
}

fn assert_passes(battery: &Battery) {
    assert!(battery.ended.is_ok(), "{:?}", battery.ended);
    assert!(battery.failed().is_empty() && battery.not_judged().is_empty(), "{:#?}", battery.results);
    assert!(battery.results.len() > 100, "{} checks", battery.results.len());
}

#[test]
fn logs_between_any_two_frames_are_borne() {
    assert_passes(&Battery::of(Altered::new(|message, Passing { device_us, .. }| {
        [log(device_us), whole(message), log(device_us)].concat()
    })));
}

#[test]
fn frames_of_a_new_kind_are_borne() {
    assert_passes(&Battery::of(Altered::new(|message, _| {
        [Frame::around(&[0xe7, 1, 2, 3]).to_vec(), whole(message)].concat()
    })));
}

/// Longer bodies, a flag in every torque, a capability, and a kind after every message.
#[test]
fn a_drive_of_the_next_minor_version_passes_every_check() {
    assert_passes(&Battery::of(Altered::new(|message, _| {
        let mut newer = message.message;
        match &mut newer {
            DriveMessage::Identity(it) => {
                it.minor_version = 1;
                it.capabilities |= Capabilities::from_bits_retain(0x80);
            }
            DriveMessage::TorqueAnswer(it) => it.status.flags |= TorqueFlags::from_bits_retain(NEW_FLAG),
            _ => {}
        }
        let mut stuffed = newer.numbered_frame(message.number).to_vec();
        stuffed.pop();
        let mut body = frame::open(&mut stuffed).expect("a good frame").to_vec();
        // The values of telemetry and of a capture fill their body.
        let fills = matches!(newer, DriveMessage::Telemetry(_) | DriveMessage::CaptureRows(_));
        if body.len() + 2 <= MAX_BODY && !fills {
            body.extend([1, 2]);
        }
        [Frame::around(&body).to_vec(), Frame::around(&[0x9c, 1, 2, 3]).to_vec()].concat()
    })));
}

#[test]
fn a_silent_drive_ends_the_battery_after_three_checks() {
    // The handshake, the description and some checks are answered.
    let battery = Battery::of(Altered::new(
        |message, Passing { requests, .. }| {
            if requests < 400 { whole(message) } else { Vec::new() }
        },
    ));
    let error = battery.ended.expect_err("a drive that is lost");
    assert!(error.is_loss(), "{error}");
    let silent = &battery.results[battery.results.len() - 3..];
    let failed = |status: &CheckStatus| matches!(status, CheckStatus::Failed { got, .. } if got == "nothing");
    assert!(failed(&silent[0].status), "{silent:#?}");
    assert!(silent.iter().all(|it| it.status != CheckStatus::Passed), "{silent:#?}");
}

#[test]
fn a_drive_that_never_describes_itself_fails() {
    let battery = Battery::of(Altered::new(|message, _| match &message.message {
        DriveMessage::ParameterDescription(it) => {
            instead(message, ParameterDescription { index: it.index ^ 1, ..*it })
        }
        _ => whole(message),
    }));
    assert!(battery.ended.is_ok(), "{:?}", battery.ended);
    let [failed] = &battery.results[..] else { panic!("{:#?}", battery.results) };
    assert_eq!(failed.name, "the drive describes all that it announces");
    assert!(
        matches!(&failed.status, CheckStatus::Failed { got, .. } if got.contains("DescribeParameter")),
        "{failed:#?}"
    );
}

/// `Start` is done and answered as refused.
#[test]
fn a_failed_preparation_fails_one_check_and_leaves_the_others_unjudged() {
    let battery = Battery::of(Altered::new(|message, _| match &message.message {
        DriveMessage::CommandResult(it) if it.request == Start::LAYOUT.kind => {
            instead(message, CommandResult { outcome: Outcome::WrongSession, state: State::Armed, ..*it })
        }
        _ => whole(message),
    }));
    let not_judged = battery.not_judged();
    assert!(not_judged.len() > 40, "{} of {}", not_judged.len(), battery.results.len());
    let failed = battery.failed();
    assert!((1..10).contains(&failed.len()), "{failed:#?}");
    let first = failed
        .iter()
        .find(|it| matches!(&it.status, CheckStatus::Failed { expected, .. } if expected.starts_with("Start before")))
        .expect("a check that reports the preparation");
    let CheckStatus::Failed { expected, got } = &first.status else { unreachable!() };
    assert_eq!(expected, "Start before the check: Start: outcome and state Accepted, Running");
    assert_eq!(got, "WrongSession, Armed");
    let cause = format!("Start, see \"{}\"", first.name);
    for it in not_judged {
        assert_eq!(it.status, CheckStatus::NotJudged { cause: cause.clone() }, "{}", it.name);
    }
}

#[test]
fn a_slow_drive_ends_the_battery_after_a_minute() {
    let battery = Battery::of(Altered::slow(Duration::from_millis(300)));
    assert!(battery.ended.is_ok(), "{:?}", battery.ended);
    let took: Duration = battery.results.iter().map(|it| it.took).sum();
    assert!(took <= Duration::from_secs(61), "{took:?}");
    let last = battery.results.last().map(|it| it.status.clone());
    assert_eq!(last, Some(CheckStatus::NotJudged { cause: "60 s have passed".to_owned() }));
    for it in &battery.results {
        assert!(it.took <= Duration::from_millis(5_500), "{} took {:?}", it.name, it.took);
    }
}

#[test]
fn another_time_limit_ends_the_battery_and_an_attempt_at_a_twelfth_of_it() {
    let battery = Battery::within(Duration::from_secs(120), Altered::slow(Duration::from_millis(300)));
    let last = battery.results.last().map(|it| it.status.clone());
    assert_eq!(last, Some(CheckStatus::NotJudged { cause: "120 s have passed".to_owned() }));
    let of_attempt = CheckStatus::NotJudged { cause: "10 s have passed in this check".to_owned() };
    assert!(battery.results.iter().any(|it| it.status == of_attempt), "{:#?}", battery.not_judged());
}

#[test]
fn time_for_which_the_drives_program_waits_for_a_core_counts_against_no_limit() {
    let battery = Battery::of(Altered::starved(Duration::from_millis(300)));
    assert!(battery.ended.is_ok(), "{:?}", battery.ended);
    let took: Duration = battery.results.iter().map(|it| it.took).sum();
    assert!(took > Duration::from_secs(120), "{took:?}");
    let is_cut = |status: &CheckStatus| matches!(status, CheckStatus::NotJudged { cause } if cause.contains("have passed"));
    let cut: Vec<_> = battery.results.iter().filter(|it| is_cut(&it.status)).map(|it| &it.name).collect();
    assert!(cut.is_empty(), "{cut:#?}");
}

#[test]
fn a_bench_that_stands_still_now_and_then_fails_no_good_drive() {
    for writes in [29, 97, 397, 997] {
        let battery = Battery::of(Altered::on_a_busy_bench(writes, Duration::from_millis(250)));
        assert!(battery.ended.is_ok(), "{:?}", battery.ended);
        let failed: Vec<_> = battery.failed().iter().map(|it| (&it.name, &it.status)).collect();
        assert!(failed.is_empty(), "one write in {writes}: {failed:#?}");
        let not_judged = battery.not_judged();
        assert!(writes < 397 || not_judged.len() < battery.results.len() / 10, "{not_judged:#?}");
    }
}

#[test]
fn an_answer_that_comes_after_all_fails_no_good_drive() {
    for write in (20..1_300).step_by(64) {
        let battery = Battery::of(Altered::standing_still(write, Duration::from_millis(1_700)));
        assert!(battery.ended.is_ok(), "{:?}", battery.ended);
        let failed: Vec<_> = battery.failed().iter().map(|it| (&it.name, &it.status)).collect();
        assert!(failed.is_empty(), "from write {write} on: {failed:#?}");
    }
}

/// Every answer comes with many more, in one check after the other.
#[test]
fn a_flood_of_answers_fails_in_a_few_words() {
    let flood: [Alteration; 2] = [
        |it, _| match &it.message {
            DriveMessage::TorqueAnswer(torque) => {
                let values = TelemetryValues::new(&[0.5; 13]).expect("13 values");
                let telemetry = Telemetry { sequence: torque.sequence, values };
                [whole(it), instead(it, telemetry).repeat(2_000)].concat()
            }
            _ => whole(it),
        },
        |it, _| whole(it).repeat(50),
    ];
    for alter in flood {
        let battery = Battery::of(Altered::new(alter));
        assert!(!battery.failed().is_empty(), "{:#?}", battery.results);
        let texts = battery.results.iter().map(|it| serde_json::to_string(it).expect("a result"));
        let all: Vec<_> = texts.collect();
        assert!(all.iter().map(String::len).sum::<usize>() < 1_000_000);
        for it in battery.failed() {
            let CheckStatus::Failed { expected, got } = &it.status else { unreachable!() };
            assert!(expected.chars().count() <= 600 && got.chars().count() <= 600, "{}: {got}", it.name);
        }
    }
}

#[test]
fn a_value_without_end_fails_and_a_name_to_be_quoted_is_noted() {
    let battery = Battery::of(Altered::new(|it, _| match &it.message {
        DriveMessage::ParameterDescription(parameter) if parameter.name.as_str() == "k_p1" => {
            let max = ParameterValue::F32(f32::INFINITY);
            instead(it, ParameterDescription { name: Text::new("k p1"), max, ..*parameter })
        }
        _ => whole(it),
    }));
    let of = |name: &str| battery.results.iter().find(|it| it.name == name).expect("a check");
    let finite = of("default, minimum and maximum are finite");
    assert!(matches!(finite.status, CheckStatus::Failed { .. }), "{finite:#?}");
    let names = of("every parameter name is unique");
    assert_eq!(names.status, CheckStatus::Passed);
    assert_eq!(names.note, "warning: in a scenario these names need quotes: k p1");
}

/// The specification's words and units, none of Rust's.
#[test]
fn a_failure_is_reported_in_the_words_of_the_specification() {
    let battery = Battery::of(Altered::new(|message, _| match &message.message {
        DriveMessage::TorqueAnswer(it) if it.status.state == State::Idle => {
            instead(message, TorqueAnswer { torque_nm: 0.5, ..*it })
        }
        _ => whole(message),
    }));
    let failed = battery.failed();
    let idle = failed.iter().find(|it| it.name == "a sample gets torque zero in Idle").expect("a failure");
    let CheckStatus::Failed { expected, got } = &idle.status else { unreachable!() };
    assert_eq!(expected, "sequence, torque in N m, state and flags 0, 0, Idle, no flags");
    assert_eq!(got, "0, 0.5, Idle, no flags");
    for it in failed {
        let CheckStatus::Failed { expected, got } = &it.status else { unreachable!() };
        for text in [expected, got] {
            assert!(!text.contains(['{', '}', '[', ']']) && !text.contains("Some("), "{}: {text}", it.name);
        }
    }
}
