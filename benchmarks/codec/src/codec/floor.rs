//! The lower bound: fields copied, and the CRC. No delimiter, no kinds, no resynchronisation.

use lashloop_protocol::crc::checksum;

use super::Codec;
use crate::cycle::{Sample, Torque};

#[derive(Default)]
pub struct Floor;

/// Length of the body, as in our protocol: a kind byte and the fields.
const SAMPLE: usize = 13;
const TORQUE: usize = 10;
/// Length of the CRC.
const CRC: usize = 4;

/// A field of `N` bytes at offset `at` after the kind.
#[inline(always)]
fn field<const N: usize>(bytes: [u8; N], at: usize) -> u128 {
    let mut word = [0; size_of::<u128>()];
    word[..N].copy_from_slice(&bytes);
    u128::from_le_bytes(word) << (8 * at)
}

/// By value, because fields written to memory and read back as words would stall on store forwarding.
#[inline(always)]
fn close<const BODY: usize, const ALL: usize>(kind: u8, fields: u128) -> [u8; ALL] {
    let bytes = |word: u128| {
        let mut bytes = [kind; 1 + size_of::<u128>()];
        bytes[1..].copy_from_slice(&word.to_le_bytes());
        bytes
    };
    let crc = checksum(&bytes(fields)[..BODY]);
    *bytes(fields | field(crc.to_le_bytes(), BODY - 1)).first_chunk().expect("a whole frame")
}

#[inline(always)]
fn open<const BODY: usize>(frame: &[u8]) -> &[u8; BODY] {
    let (body, crc) = frame.split_first_chunk().expect("a body");
    assert!(checksum(body).to_le_bytes() == crc, "the CRC");
    body
}

fn low_three(counts: i32) -> [u8; 3] {
    let [low, middle, high, _] = counts.to_le_bytes();
    [low, middle, high]
}

fn counts(body: &[u8; SAMPLE], at: usize) -> i32 {
    i32::from_le_bytes([0, body[at], body[at + 1], body[at + 2]]) >> 8
}

impl Codec<Sample> for Floor {
    #[inline(always)]
    fn encode(&mut self, value: &Sample, send: impl FnOnce(&[u8])) {
        let fields = field(value.sequence.to_le_bytes(), 0)
            | field(low_three(value.motor_counts), 2)
            | field(low_three(value.load_counts), 5)
            | field(value.reference_rad.to_le_bytes(), 8);
        send(&close::<SAMPLE, { SAMPLE + CRC }>(0x10, fields));
    }

    #[inline(always)]
    fn decode(&mut self, frame: &[u8]) -> Sample {
        let body: &[u8; SAMPLE] = open(frame);
        Sample {
            sequence: u16::from_le_bytes([body[1], body[2]]),
            motor_counts: counts(body, 3),
            load_counts: counts(body, 6),
            reference_rad: f32::from_le_bytes([body[9], body[10], body[11], body[12]]),
        }
    }
}

impl Codec<Torque> for Floor {
    #[inline(always)]
    fn encode(&mut self, value: &Torque, send: impl FnOnce(&[u8])) {
        let fields = field(value.sequence.to_le_bytes(), 0)
            | field(value.torque_nm.to_le_bytes(), 2)
            | field([value.state | value.flags], 6)
            | field(value.compute_tenths_us.to_le_bytes(), 7);
        send(&close::<TORQUE, { TORQUE + CRC }>(0x90, fields));
    }

    #[inline(always)]
    fn decode(&mut self, frame: &[u8]) -> Torque {
        let b: &[u8; TORQUE] = open(frame);
        Torque {
            sequence: u16::from_le_bytes([b[1], b[2]]),
            torque_nm: f32::from_le_bytes([b[3], b[4], b[5], b[6]]),
            state: b[7] & 0x0f,
            flags: b[7] & 0xf0,
            compute_tenths_us: u16::from_le_bytes([b[8], b[9]]),
        }
    }
}
