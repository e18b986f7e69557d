//! Mutants of the law `pd`: the real drive behind a filter on samples and torques.

use std::time::Instant;

use lashloop_conformance::CheckStatus;
use lashloop_link::in_process::InProcess;
use lashloop_link::{Link, LinkError, TimeBase};
use lashloop_protocol::enums::State;
use lashloop_protocol::frame::DELIMITER;
use lashloop_protocol::message::{EncoderSample, TorqueAnswer};
use lashloop_protocol::{Decoder, DriveMessage, EncoderCounts, HostMessage, Message, Numbered};

use crate::laws::TestLaws;
use crate::results;

/// A drive behind a filter.
struct Filtered {
    drive: InProcess<TestLaws>,
    on_sample: fn(&mut EncoderSample),
    on_torque: fn(&mut TorqueAnswer),
    request: Vec<u8>,
    decoder: Decoder,
    answers: Vec<u8>,
}

impl Filtered {
    fn new(on_sample: fn(&mut EncoderSample), on_torque: fn(&mut TorqueAnswer)) -> Self {
        let [request, answers] = [vec![], vec![]];
        Self { drive: InProcess::default(), on_sample, on_torque, request, decoder: Decoder::new(), answers }
    }
}

impl Link for Filtered {
    fn inner(&mut self) -> Option<&mut dyn Link> {
        Some(&mut self.drive)
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        for byte in bytes {
            self.request.push(*byte);
            if *byte == DELIMITER {
                let frame = std::mem::take(&mut self.request);
                match Decoder::new().next::<HostMessage>(&mut &*frame) {
                    Some(Ok(Numbered { message: HostMessage::EncoderSample(mut sample), .. })) => {
                        (self.on_sample)(&mut sample);
                        self.drive.send(&HostMessage::from(sample).frame())?;
                    }
                    _ => self.drive.send(&frame)?,
                }
            }
        }
        Ok(())
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
        let mut bytes = [0; 64];
        while self.answers.is_empty() {
            let count = self.drive.receive(&mut bytes, deadline)?;
            if count == 0 {
                return Ok(0);
            }
            let mut rest = &bytes[..count];
            while let Some(answer) = self.decoder.next::<DriveMessage>(&mut rest) {
                let mut answer = answer.expect("a good frame");
                if let DriveMessage::TorqueAnswer(torque) = &mut answer.message {
                    (self.on_torque)(torque);
                }
                self.answers.extend_from_slice(&answer.message.numbered_frame(answer.number));
            }
        }
        let count = self.answers.len().min(buffer.len());
        buffer[..count].copy_from_slice(&self.answers[..count]);
        self.answers.drain(..count);
        Ok(count)
    }

    fn discard_input(&mut self) -> Result<(), LinkError> {
        self.answers.clear();
        self.decoder.forget_partial();
        self.drive.discard_input()
    }

    fn set_time_base(&mut self, time_base: TimeBase) {
        self.drive.set_time_base(time_base);
    }
}

fn assert_fails(drive: Filtered, run: &str) {
    let name = format!("the law pd requests the torques of the golden trace, run {run}");
    let results = results(drive);
    let result = results.iter().find(|it| it.name == name).expect("a check of this name");
    assert!(matches!(result.status, CheckStatus::Failed { .. }), "{result:?}");
}

#[test]
fn two_thousandths_of_a_torque_too_much_are_found() {
    let stronger = |it: &mut TorqueAnswer| {
        if it.status.state == State::Running && it.torque_nm.abs() < 19.0 {
            it.torque_nm *= 1.002;
        }
    };
    assert_fails(Filtered::new(|_| {}, stronger), "coarse");
}

#[test]
fn lowest_bits_of_the_load_that_are_lost_are_found() {
    let coarser = |it: &mut EncoderSample| {
        it.load_counts = EncoderCounts::wrapping(i64::from(it.load_counts.get()) & !0xff);
    };
    assert_fails(Filtered::new(coarser, |_| {}), "fine");
}
