//! Protocol buffers delimited by the `cobs` crate, without a CRC (the usual combination) and with ours.
//!
//! One message per direction has a `oneof` over its kinds, the usual way to distinguish kinds with prost.

use prost::{Message, Oneof};

use super::Codec;
use super::framing::Framing;
use crate::cycle::{Sample, Torque};

#[derive(Clone, PartialEq, Message)]
struct HostMessage {
    #[prost(oneof = "Host", tags = "1, 2")]
    kind: Option<Host>,
}

#[derive(Clone, PartialEq, Oneof)]
enum Host {
    #[prost(message, tag = "1")]
    Sample(SampleMessage),
    #[prost(message, tag = "2")]
    Stop(StopMessage),
}

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
struct StopMessage {}

#[derive(Clone, PartialEq, Message)]
struct DriveMessage {
    #[prost(oneof = "Drive", tags = "1, 2")]
    kind: Option<Drive>,
}

#[derive(Clone, PartialEq, Oneof)]
enum Drive {
    #[prost(message, tag = "1")]
    Torque(TorqueMessage),
    #[prost(message, tag = "2")]
    Stopped(StopMessage),
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

/// With the CRC-32C of the other codecs, or without a CRC.
#[derive(Default)]
pub struct Protobuf<const CRC: bool>(Framing<CRC>);

impl<const CRC: bool> Protobuf<CRC> {
    fn send(&mut self, message: &impl Message, send: impl FnOnce(&[u8])) {
        let write = |mut buffer: &mut [u8]| {
            let len = buffer.len();
            message.encode(&mut buffer).expect("a large enough buffer");
            len - buffer.len()
        };
        self.0.send(write, send);
    }

    fn open<M: Message + Default>(&mut self, frame: &[u8]) -> M {
        M::decode(self.0.open(frame)).expect("a message")
    }
}

impl<const CRC: bool> Codec<Sample> for Protobuf<CRC> {
    const CHECKED: bool = CRC;

    #[inline(always)]
    fn encode(&mut self, value: &Sample, send: impl FnOnce(&[u8])) {
        let Sample { sequence, motor_counts, load_counts, reference_rad } = *value;
        let sequence = sequence.into();
        let sample = SampleMessage { sequence, motor_counts, load_counts, reference_rad };
        self.send(&HostMessage { kind: Some(Host::Sample(sample)) }, send);
    }

    fn decode(&mut self, frame: &[u8]) -> Sample {
        let Some(Host::Sample(sample)) = self.open::<HostMessage>(frame).kind else { panic!("no sample") };
        let SampleMessage { sequence, motor_counts, load_counts, reference_rad } = sample;
        Sample { sequence: sequence as u16, motor_counts, load_counts, reference_rad }
    }
}

impl<const CRC: bool> Codec<Torque> for Protobuf<CRC> {
    const CHECKED: bool = CRC;

    #[inline(always)]
    fn encode(&mut self, value: &Torque, send: impl FnOnce(&[u8])) {
        let torque = TorqueMessage {
            sequence: value.sequence.into(),
            torque_nm: value.torque_nm,
            state: value.state.into(),
            flags: value.flags.into(),
            compute_tenths_us: value.compute_tenths_us.into(),
        };
        self.send(&DriveMessage { kind: Some(Drive::Torque(torque)) }, send);
    }

    fn decode(&mut self, frame: &[u8]) -> Torque {
        let Some(Drive::Torque(torque)) = self.open::<DriveMessage>(frame).kind else { panic!("no torque") };
        Torque {
            sequence: torque.sequence as u16,
            torque_nm: torque.torque_nm,
            state: torque.state as u8,
            flags: torque.flags as u8,
            compute_tenths_us: torque.compute_tenths_us as u16,
        }
    }
}
