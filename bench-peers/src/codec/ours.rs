//! The protocol as the bench uses it.

use lashloop_protocol::message::{EncoderSample, TorqueAnswer};
use lashloop_protocol::vocabulary::TorqueStatus;
use lashloop_protocol::{Decoder, DriveMessage, EncoderCounts, HostMessage, Message};

use super::Codec;
use crate::cycle::{Sample, Torque};

#[derive(Default)]
pub struct Ours(Decoder);

impl Codec<Sample> for Ours {
    fn encode(&mut self, value: &Sample, send: impl FnOnce(&[u8])) {
        let Sample { sequence, motor_counts, load_counts, reference_rad } = *value;
        let [motor_counts, load_counts] =
            [motor_counts, load_counts].map(|counts| EncoderCounts::wrapping(counts.into()));
        let sample = EncoderSample { sequence, motor_counts, load_counts, reference_rad };
        send(&HostMessage::from(sample).frame());
    }

    fn decode(&mut self, mut frame: &[u8]) -> Sample {
        let Some(Ok(HostMessage::EncoderSample(sample))) = self.0.next(&mut frame) else {
            panic!("no sample")
        };
        let EncoderSample { sequence, motor_counts, load_counts, reference_rad } = sample;
        let [motor_counts, load_counts] = [motor_counts, load_counts].map(EncoderCounts::get);
        Sample { sequence, motor_counts, load_counts, reference_rad }
    }
}

impl Codec<Torque> for Ours {
    fn encode(&mut self, value: &Torque, send: impl FnOnce(&[u8])) {
        let Torque { sequence, torque_nm, state, flags, compute_tenths_us } = *value;
        let status = TorqueStatus::from_byte(state | flags).expect("a status");
        let answer = TorqueAnswer { sequence, torque_nm, status, compute_tenths_us };
        send(&DriveMessage::from(answer).frame());
    }

    fn decode(&mut self, mut frame: &[u8]) -> Torque {
        let Some(Ok(DriveMessage::TorqueAnswer(answer))) = self.0.next(&mut frame) else {
            panic!("no torque")
        };
        let TorqueAnswer { sequence, torque_nm, status, compute_tenths_us } = answer;
        let TorqueStatus { state, flags } = status;
        Torque { sequence, torque_nm, state: state as u8, flags: flags.bits(), compute_tenths_us }
    }
}
