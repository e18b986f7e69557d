//! The description of a drive whose answers are altered on the way.

use std::time::Instant;

use lashloop_link::in_process::InProcess;
use lashloop_link::{Link, LinkError};
use lashloop_protocol::enums::{Outcome, State};
use lashloop_protocol::message::{CommandResult, ParameterReport};
use lashloop_protocol::{Decoder, MAX_FRAME, Message};

use super::*;
use crate::handshake::shake_hands;

type Alteration = fn(DriveMessage) -> DriveMessage;

/// The drive in process; each of its answers passes an alteration.
struct Altered {
    drive: InProcess,
    decoder: Decoder,
    alteration: Alteration,
}

impl Link for Altered {
    fn inner(&mut self) -> Option<&mut dyn Link> {
        Some(&mut self.drive)
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.drive.send(bytes)
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
        let mut received = [0; 1024];
        let count = self.drive.receive(&mut received, deadline)?;
        let (mut left, mut altered, mut frame) = (&received[..count], Vec::new(), [0; MAX_FRAME]);
        while let Some(answer) = self.decoder.next::<DriveMessage>(&mut left) {
            let answer = answer.expect("a good frame").map(self.alteration);
            altered.extend_from_slice(answer.message.write_numbered(answer.number, &mut frame));
        }
        buffer[..altered.len()].copy_from_slice(&altered);
        Ok(altered.len())
    }

    fn discard_input(&mut self) -> Result<(), LinkError> {
        self.drive.discard_input()
    }
}

fn read(alteration: Alteration) -> Result<Description, SessionError> {
    let link = Altered { drive: InProcess::default(), decoder: Decoder::new(), alteration };
    let mut line = Line::new(Box::new(link));
    let identity = shake_hands(&mut line, 1)?;
    Description::read(&mut line, &identity)
}

#[test]
fn a_parameter_that_the_drive_announces_and_refuses_is_no_silence() {
    let error = read(|answer| match answer {
        DriveMessage::ParameterDescription(it) if it.index == 2 => ParameterReport {
            index: 2,
            outcome: Outcome::UnknownIndex,
            value: ParameterValue::U32(0),
            state: State::Idle,
            detail: 0,
            device_time_us: None,
        }
        .into(),
        answer => answer,
    });
    let error = error.expect_err("a parameter is missing");
    assert!(
        matches!(
            error,
            SessionError::Refused {
                request: "DescribeParameter",
                outcome: Outcome::UnknownIndex,
                state: State::Idle,
                ..
            }
        ),
        "{error}"
    );
}

#[test]
fn a_request_that_is_accepted_and_not_answered_is_no_refusal() {
    let error = read(|answer| match answer {
        DriveMessage::LawDescription(_) => CommandResult {
            request: DescribeLaw::LAYOUT.kind,
            outcome: Outcome::Accepted,
            state: State::Idle,
            detail: 0,
            device_time_us: None,
        }
        .into(),
        answer => answer,
    });
    let error = error.expect_err("no name").to_string();
    assert!(error.contains("Accepted: but without the answer that the request has"), "{error}");
}

fn with_range(mut answer: DriveMessage, min: ParameterValue, max: ParameterValue) -> DriveMessage {
    if let DriveMessage::ParameterDescription(it) = &mut answer
        && it.flags.contains(ParameterFlags::CHOICES)
    {
        (it.min, it.max) = (min, max);
    }
    answer
}

#[test]
fn choices_beyond_a_byte_and_of_real_numbers_are_refused() {
    use ParameterValue::{F32, U32};
    let cases: [(Alteration, &str); 4] = [
        (|answer| with_range(answer, U32(0), U32(256)), "from 0 to 256 (U32 to U32)"),
        (|answer| with_range(answer, U32(0), U32(u32::MAX)), "from 0 to 4294967295 (U32 to U32)"),
        (|answer| with_range(answer, U32(1), U32(0)), "from 1 to 0 (U32 to U32)"),
        (|answer| with_range(answer, F32(0.0), F32(1.0)), "from 0 to 1 (F32 to F32)"),
    ];
    for (alteration, range) in cases {
        let error = read(alteration).expect_err(range).to_string();
        assert!(error.contains(&format!("choices of controller {range}; choices are U32")), "{error}");
    }
}

#[test]
fn bits_of_laws_that_the_drive_lacks_change_nothing() {
    let described = read(|answer| answer).expect("a description");
    let with_more_bits = read(|mut answer| {
        match &mut answer {
            DriveMessage::ParameterDescription(it) if it.index % 2 == 1 => it.laws |= 0xff00,
            DriveMessage::SignalDescription(it) if it.index % 2 == 1 => it.laws |= 0xff00,
            _ => {}
        }
        answer
    });
    assert!(described.laws.len() <= 8);
    assert_eq!(with_more_bits.expect("a description"), described);
}

#[test]
fn counts_that_no_drive_can_have_are_rejected_by_field() {
    let cases: [(Alteration, &str); 4] = [
        (|answer| with_counts(answer, 0, 3), "law_count 0, allowed are 1 to 16"),
        (|answer| with_counts(answer, 17, 3), "law_count 17, allowed are 1 to 16"),
        (|answer| with_counts(answer, 4, 33), "signal_count 33, allowed are 0 to 32"),
        (with_241_parameters, "parameter_count 241, allowed are 0 to 240"),
    ];
    for (alteration, want) in cases {
        let error = read(alteration).expect_err(want).to_string();
        assert!(error.contains(want), "{error}");
    }
}

fn with_241_parameters(answer: DriveMessage) -> DriveMessage {
    match answer {
        DriveMessage::Identity(it) => Identity { parameter_count: 241, ..it }.into(),
        other => other,
    }
}

fn with_counts(answer: DriveMessage, law_count: u8, signal_count: u8) -> DriveMessage {
    match answer {
        DriveMessage::Identity(it) => Identity { law_count, signal_count, ..it }.into(),
        other => other,
    }
}
