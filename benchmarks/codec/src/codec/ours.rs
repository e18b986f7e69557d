//! The protocol as the bench uses it.

use lashloop_protocol::enums::TorqueStatus;
use lashloop_protocol::message::{EncoderSample, TorqueAnswer};
use lashloop_protocol::{Decoder, DriveMessage, EncoderCounts, HostMessage, MAX_FRAME, Message, Numbered};

use super::Codec;
use crate::cycle::{Sample, Torque};

pub struct Ours {
    decoder: Decoder,
    buffer: [u8; MAX_FRAME],
}

impl Default for Ours {
    fn default() -> Self {
        Self { decoder: Decoder::new(), buffer: [0; MAX_FRAME] }
    }
}

impl Codec<Sample> for Ours {
    #[inline(always)]
    fn encode(&mut self, value: &Sample, send: impl FnOnce(&[u8])) {
        let Sample { sequence, motor_counts, load_counts, reference_rad } = *value;
        let [motor_counts, load_counts] =
            [motor_counts, load_counts].map(|counts| EncoderCounts::wrapping(counts.into()));
        let sample = EncoderSample { sequence, motor_counts, load_counts, reference_rad };
        send(HostMessage::from(sample).write_frame(&mut self.buffer));
    }

    #[inline(always)]
    fn decode(&mut self, mut frame: &[u8]) -> Sample {
        let Some(Ok(Numbered { message: HostMessage::EncoderSample(sample), .. })) =
            self.decoder.next(&mut frame)
        else {
            panic!("no sample")
        };
        let EncoderSample { sequence, motor_counts, load_counts, reference_rad } = sample;
        let [motor_counts, load_counts] = [motor_counts, load_counts].map(EncoderCounts::get);
        Sample { sequence, motor_counts, load_counts, reference_rad }
    }
}

impl Codec<Torque> for Ours {
    #[inline(always)]
    fn encode(&mut self, value: &Torque, send: impl FnOnce(&[u8])) {
        let Torque { sequence, torque_nm, state, flags, compute_tenths_us } = *value;
        let status = TorqueStatus::from_byte(state | flags).expect("a status");
        let answer = TorqueAnswer { sequence, torque_nm, status, compute_tenths_us };
        send(DriveMessage::from(answer).write_frame(&mut self.buffer));
    }

    #[inline(always)]
    fn decode(&mut self, mut frame: &[u8]) -> Torque {
        let Some(Ok(Numbered { message: DriveMessage::TorqueAnswer(answer), .. })) =
            self.decoder.next(&mut frame)
        else {
            panic!("no torque")
        };
        let TorqueAnswer { sequence, torque_nm, status, compute_tenths_us } = answer;
        let TorqueStatus { state, flags } = status;
        Torque { sequence, torque_nm, state: state.byte(), flags: flags.bits(), compute_tenths_us }
    }
}
