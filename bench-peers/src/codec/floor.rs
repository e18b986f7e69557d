//! What nobody gets below: the fields copied, and the CRC. No delimiter, no kinds, no resynchronisation.

use lashloop_protocol::crc::checksum;

use super::Codec;
use crate::cycle::{Sample, Torque};

#[derive(Default)]
pub struct Floor;

/// As long as the body of ours: there is a kind byte.
const SAMPLE: usize = 17;
const TORQUE: usize = 13;

/// By value: the fields are still in registers when the CRC reads them.
fn close<const BODY: usize, const ALL: usize>(body: [u8; BODY]) -> [u8; ALL] {
    let mut bytes = [0; ALL];
    bytes[..BODY].copy_from_slice(&body);
    bytes[BODY..].copy_from_slice(&checksum(&body).to_le_bytes());
    bytes
}

fn open<const BODY: usize>(frame: &[u8]) -> &[u8; BODY] {
    let (body, crc) = frame.split_first_chunk().expect("there is a body");
    assert_eq!(checksum(body).to_le_bytes(), crc);
    body
}

fn word(body: &[u8; SAMPLE], at: usize) -> [u8; 4] {
    body[at..at + 4].try_into().expect("four bytes")
}

impl Codec<Sample> for Floor {
    fn encode(&mut self, value: &Sample, send: impl FnOnce(&[u8])) {
        let mut bytes = [0x10; SAMPLE];
        bytes[1..5].copy_from_slice(&value.sequence.to_le_bytes());
        bytes[5..9].copy_from_slice(&value.motor_counts.to_le_bytes());
        bytes[9..13].copy_from_slice(&value.load_counts.to_le_bytes());
        bytes[13..17].copy_from_slice(&value.reference_rad.to_le_bytes());
        send(&close::<SAMPLE, { SAMPLE + 4 }>(bytes));
    }

    fn decode(&mut self, frame: &[u8]) -> Sample {
        let body: &[u8; SAMPLE] = open(frame);
        Sample {
            sequence: u32::from_le_bytes(word(body, 1)),
            motor_counts: i32::from_le_bytes(word(body, 5)),
            load_counts: i32::from_le_bytes(word(body, 9)),
            reference_rad: f32::from_le_bytes(word(body, 13)),
        }
    }
}

impl Codec<Torque> for Floor {
    fn encode(&mut self, value: &Torque, send: impl FnOnce(&[u8])) {
        let mut bytes = [0x90; TORQUE];
        bytes[1..5].copy_from_slice(&value.sequence.to_le_bytes());
        bytes[5..9].copy_from_slice(&value.torque_nm.to_le_bytes());
        bytes[9..11].copy_from_slice(&[value.state, value.flags]);
        bytes[11..13].copy_from_slice(&value.compute_tenths_us.to_le_bytes());
        send(&close::<TORQUE, { TORQUE + 4 }>(bytes));
    }

    fn decode(&mut self, frame: &[u8]) -> Torque {
        let b: &[u8; TORQUE] = open(frame);
        Torque {
            sequence: u32::from_le_bytes([b[1], b[2], b[3], b[4]]),
            torque_nm: f32::from_le_bytes([b[5], b[6], b[7], b[8]]),
            state: b[9],
            flags: b[10],
            compute_tenths_us: u16::from_le_bytes([b[11], b[12]]),
        }
    }
}
