//! Protocol buffers, delimited by the `cobs` crate; without a CRC, as users of both leave it.

use prost::Message;

use super::Codec;
use crate::cycle::{Sample, Torque};

#[derive(Clone, PartialEq, Message)]
struct SampleMessage {
    #[prost(uint32, tag = "1")]
    sequence: u32,
    #[prost(sint32, tag = "2")]
    motor_counts: i32,
    #[prost(sint32, tag = "3")]
    load_counts: i32,
    #[prost(float, tag = "4")]
    reference_rad: f32,
}

#[derive(Clone, PartialEq, Message)]
struct TorqueMessage {
    #[prost(uint32, tag = "1")]
    sequence: u32,
    #[prost(float, tag = "2")]
    torque_nm: f32,
    #[prost(uint32, tag = "3")]
    state: u32,
    #[prost(uint32, tag = "4")]
    flags: u32,
    #[prost(uint32, tag = "5")]
    compute_tenths_us: u32,
}

pub struct Protobuf {
    plain: [u8; 64],
    stuffed: [u8; 64],
}

impl Default for Protobuf {
    fn default() -> Self {
        Self { plain: [0; 64], stuffed: [0; 64] }
    }
}

impl Protobuf {
    fn send(&mut self, message: &impl Message, send: impl FnOnce(&[u8])) {
        let mut room = &mut self.plain[..];
        message.encode(&mut room).expect("room");
        let left = room.len();
        let end = cobs::encode(&self.plain[..self.plain.len() - left], &mut self.stuffed);
        self.stuffed[end] = 0;
        send(&self.stuffed[..=end]);
    }

    fn open<M: Message + Default>(&mut self, frame: &[u8]) -> M {
        let end = cobs::decode(&frame[..frame.len() - 1], &mut self.plain).expect("stuffed").frame_size();
        M::decode(&self.plain[..end]).expect("a message")
    }
}

impl Codec<Sample> for Protobuf {
    fn encode(&mut self, value: &Sample, send: impl FnOnce(&[u8])) {
        let Sample { sequence, motor_counts, load_counts, reference_rad } = *value;
        self.send(&SampleMessage { sequence, motor_counts, load_counts, reference_rad }, send);
    }

    fn decode(&mut self, frame: &[u8]) -> Sample {
        let SampleMessage { sequence, motor_counts, load_counts, reference_rad } = self.open(frame);
        Sample { sequence, motor_counts, load_counts, reference_rad }
    }
}

impl Codec<Torque> for Protobuf {
    fn encode(&mut self, value: &Torque, send: impl FnOnce(&[u8])) {
        let message = TorqueMessage {
            sequence: value.sequence,
            torque_nm: value.torque_nm,
            state: value.state.into(),
            flags: value.flags.into(),
            compute_tenths_us: value.compute_tenths_us.into(),
        };
        self.send(&message, send);
    }

    fn decode(&mut self, frame: &[u8]) -> Torque {
        let message: TorqueMessage = self.open(frame);
        Torque {
            sequence: message.sequence,
            torque_nm: message.torque_nm,
            state: message.state as u8,
            flags: message.flags as u8,
            compute_tenths_us: message.compute_tenths_us as u16,
        }
    }
}
