//! How a PC writes and reads the one message of each direction that is sent in every control period.
//!
//! The bytes are those of [`crate::frame::write`] and [`crate::frame::open`], which a microcontroller uses for every message
//! and a PC for all others. What makes the difference:
//!
//! - The kind is known, so lengths are constants and nothing loops over bytes.
//! - What lies between kind and delimiter stays in two registers: bytes that are written one by one and read as a word have
//!   to wait for each other.
//! - Where zeros are is beyond any processor's guess, and a wrong guess costs more than all the rest. So a writer takes the
//!   distances of a word out of a table, wherever its zeros are. A reader follows the chain, but asks only from the second
//!   zero on whether there is one.

mod swar;

use swar::WORD;

use crate::crc;
use crate::frame::{DELIMITER, MAX_FRAME};
use crate::wire::Payload;

/// Where the fields begin: behind code and kind.
const FIELDS: usize = 2;
/// Bytes behind the kind that are held in two words.
const TAIL: usize = size_of::<u128>();

/// Bytes of fields and CRC.
const fn tail_len<P: Payload>() -> usize {
    let len = P::LAYOUT.body_len - 1 + crc::LEN;
    assert!(WORD < len && len <= TAIL, "fields and CRC of a periodic message need two words");
    len
}

/// Bits before the CRC.
const fn fields_bits<P: Payload>() -> usize {
    8 * (P::LAYOUT.body_len - 1)
}

/// Writes the frame of a message to the beginning of `room`.
#[inline(always)]
pub(crate) fn write<'room, P: Payload>(payload: &P, room: &'room mut [u8; MAX_FRAME]) -> &'room [u8] {
    let len = const { tail_len::<P>() };
    let fields = fields(payload);
    let tail = fields | u128::from(checksum::<P>(fields)) << fields_bits::<P>();
    let (first, [low, high]) = swar::with_distances([tail as u64, (tail >> u64::BITS) as u64]);

    room[0] = (FIELDS + first) as u8;
    room[1] = P::LAYOUT.kind;
    room[FIELDS..][..WORD].copy_from_slice(&low.to_le_bytes());
    room[FIELDS + WORD..][..WORD].copy_from_slice(&high.to_le_bytes());
    room[FIELDS + len] = DELIMITER;
    &room[..=FIELDS + len]
}

/// The message at the beginning of `input`, and what comes after it; `None` if there is no whole and good frame of this
/// kind, whatever there is instead.
#[inline(always)]
pub(crate) fn split_off<P: Payload>(input: &[u8]) -> Option<(P, &[u8])> {
    let len = const { tail_len::<P>() };
    let (frame, rest) = input.split_at_checked(FIELDS + len + 1)?;
    let (&delimiter, stuffed) = frame.split_last()?;
    // With a first distance of 1 the kind byte is a link: it looks right but stands for a zero.
    if stuffed[0] <= 1 || stuffed[1] != P::LAYOUT.kind || delimiter != DELIMITER {
        return None;
    }
    // The last word begins within the first.
    let [low, last] = [*stuffed[FIELDS..].first_chunk()?, *stuffed.last_chunk()?].map(u64::from_le_bytes);
    if swar::has_zero([low, last]) {
        return None;
    }
    let links = chain(frame)? >> FIELDS;
    let [low, high] = swar::without([low, last >> (8 * (TAIL - len))], links);
    let tail = u128::from(high) << u64::BITS | u128::from(low);
    if checksum::<P>(tail) != (tail >> fields_bits::<P>()) as u32 {
        return None;
    }
    Some((P::get(&plain::<P>(tail)[..P::LAYOUT.body_len]).ok()?, rest))
}

/// The fields as one number, the first in its lowest bytes.
///
/// Each is read as it was written, so none of them takes the way through memory.
#[inline(always)]
fn fields<P: Payload>(payload: &P) -> u128 {
    let mut body = [0; 1 + TAIL];
    payload.put(&mut body[..P::LAYOUT.body_len]);
    let mut fields = 0;
    for field in P::LAYOUT.fields {
        let mut word = [0; TAIL];
        word[..field.len].copy_from_slice(&body[field.offset..field.offset + field.len]);
        fields |= u128::from_le_bytes(word) << (8 * (field.offset - 1));
    }
    fields
}

/// The kind, and the tail behind it.
#[inline(always)]
fn plain<P: Payload>(tail: u128) -> [u8; 1 + TAIL] {
    let mut plain = [P::LAYOUT.kind; 1 + TAIL];
    plain[1..].copy_from_slice(&tail.to_le_bytes());
    plain
}

/// The CRC over kind and fields.
#[inline(always)]
fn checksum<P: Payload>(tail: u128) -> u32 {
    crc::checksum(&plain::<P>(tail)[..P::LAYOUT.body_len])
}

/// The chain of distances in `frame`, whose last byte is the delimiter and the only zero: bit `n` is set if byte `n` is a
/// link, but for the code byte, which always is. `None` if the chain doesn't end at the delimiter.
///
/// Whether there is a first zero is not asked but taken as given. If there is none, the delimiter is the link: a distance
/// of zero, and so still the end.
#[inline(always)]
fn chain(frame: &[u8]) -> Option<usize> {
    let end = frame.len() - 1;
    let (mut at, mut links) = (usize::from(frame[0]), 0);
    loop {
        let distance = usize::from(*frame.get(at)?);
        links |= 1 << at;
        at += distance;
        if at >= end {
            return (at == end).then_some(links);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use super::*;
    use crate::cobs;
    use crate::counts::EncoderCounts;
    use crate::enums::{State, TorqueFlags, TorqueStatus};
    use crate::message::{DriveMessage, EncoderSample, HostMessage, Message, TorqueAnswer};

    /// Samples with zeros at every choice of their 12 bytes.
    fn samples() -> impl Iterator<Item = HostMessage> {
        (0..1_u16 << 12).map(|zeros| {
            let byte = |at: usize| if zeros >> at & 1 == 1 { 0 } else { 0x9e ^ at as u8 };
            let word = |at: usize| u32::from_le_bytes([0, 1, 2, 3].map(|i| byte(at + i)));
            let counts = |at: usize| EncoderCounts::wrapping((word(at) & 0x00ff_ffff).into());
            HostMessage::from(EncoderSample {
                sequence: u16::from_le_bytes([byte(0), byte(1)]),
                motor_counts: counts(2),
                load_counts: counts(5),
                reference_rad: f32::from_bits(word(8)),
            })
        })
    }

    /// Torques with zeros at every choice of their bytes, but for the status, whose state is never zero.
    fn torques() -> impl Iterator<Item = DriveMessage> {
        (0..1_u16 << 9).map(|zeros| {
            let byte = |at: usize| if zeros >> at & 1 == 1 { 0 } else { 0x55 ^ at as u8 };
            let word = |at: usize| u32::from_le_bytes([0, 1, 2, 3].map(|i| byte(at + i)));
            let flags = TorqueFlags::from_bits_truncate(byte(6));
            DriveMessage::from(TorqueAnswer {
                sequence: u16::from_le_bytes([byte(0), byte(1)]),
                torque_nm: f32::from_bits(word(2)),
                status: TorqueStatus { state: State::Running, flags },
                compute_tenths_us: u16::from_le_bytes([byte(7), byte(8)]),
            })
        })
    }

    /// What the rest of the crate makes of the bytes up to the first delimiter.
    fn read_the_long_way<M: Message>(line: &[u8]) -> Option<(Vec<u8>, usize)> {
        let end = cobs::find_zero(line)?;
        let mut stuffed = line[..end].to_vec();
        let message = M::decode_body(crate::frame::open(&mut stuffed).ok()?).ok()?;
        Some((message.frame().to_vec(), line.len() - end - 1))
    }

    /// As bytes: a reference may be no number, and that is not equal to itself.
    fn read_quickly<M: Message>(line: &[u8]) -> Option<(Vec<u8>, usize)> {
        M::split_off_periodic(line).map(|(message, rest)| (message.frame().to_vec(), rest.len()))
    }

    fn comes_back<M: Message>(message: &M) {
        let line = [&message.frame()[..], &[7, 0]].concat();
        let want = Some((message.frame().to_vec(), 2));
        assert_eq!(read_quickly::<M>(&line), want);
        assert_eq!(read_the_long_way::<M>(&line), want);
    }

    /// Written into a room that is not empty, which the sender of a frame need not clear.
    fn is_written_as_by_the_long_way(message: &(impl Message + std::fmt::Debug), long_way: &[u8]) {
        assert_eq!(message.write_frame(&mut [0x55; MAX_FRAME]), long_way, "{message:?}");
        assert_eq!(message.frame()[..], *long_way, "{message:?}");
    }

    #[test]
    fn wherever_zeros_are_the_frame_is_that_of_the_long_way() {
        for sample in samples() {
            is_written_as_by_the_long_way(&sample, sample.write_frame_of_any_kind(&mut [0x55; MAX_FRAME]));
            comes_back(&sample);
        }
        for torque in torques() {
            is_written_as_by_the_long_way(&torque, torque.write_frame_of_any_kind(&mut [0x55; MAX_FRAME]));
            comes_back(&torque);
        }
    }

    /// Every byte of the frame replaced by every other, and by what makes the frame shorter.
    fn with_a_wrong_byte<M: Message>(message: &M) {
        let frame = message.frame();
        for at in 0..frame.len() {
            for byte in 0..=u8::MAX {
                let mut line = [&frame[..], &[7, 0]].concat();
                line[at] = byte;
                assert_eq!(read_quickly::<M>(&line), read_the_long_way::<M>(&line), "{line:02x?}");
            }
            assert_eq!(read_quickly::<M>(&frame[..at]), None, "{at} bytes of it");
        }
    }

    fn sample_whose_first_zero_is_the_last_byte_of_its_crc() -> HostMessage {
        let [motor_counts, load_counts] = [0x0001_0203, 0x0004_0506].map(EncoderCounts::wrapping);
        let sample = |bits| {
            let reference_rad = f32::from_bits(bits);
            HostMessage::from(EncoderSample { sequence: 0x0708, motor_counts, load_counts, reference_rad })
        };
        (0x3f80_0101..).map(sample).find(|sample| sample.frame()[0] == 17).expect("one in 256")
    }

    #[test]
    fn a_frame_with_a_wrong_byte_is_read_as_the_long_way_reads_it() {
        samples().step_by(171).for_each(|sample| with_a_wrong_byte(&sample));
        // The first link is 17 bytes on. If the first distance is damaged into a 1, the kind 0x10 becomes a link that leads
        // there too, and all but the kind is as it was.
        with_a_wrong_byte(&sample_whose_first_zero_is_the_last_byte_of_its_crc());
        torques().step_by(65).for_each(|torque| with_a_wrong_byte(&torque));
    }

    #[test]
    fn a_zero_that_no_link_leads_to_ends_the_frame() {
        for message in samples().step_by(251) {
            let good = message.frame();
            let end = good.len() - 1;
            let links = chain(&good).expect("a chain") | 1;
            for at in (FIELDS..end).filter(|at| links >> at & 1 == 1) {
                // The link before jumps over this one. The body would be the same, and the CRC right.
                let before = (0..at).rfind(|before| links >> before & 1 == 1).expect("the code byte");
                let mut frame = good.to_vec();
                frame[before] += frame[at];
                frame[at] = 0;
                assert_eq!(read_quickly::<HostMessage>(&frame), None, "{frame:02x?}");
            }
        }
    }

    #[test]
    fn a_right_crc_does_not_make_a_message() {
        let body = [0x90, 1, 2, 3, 4, 5, 6, 9, 0, 0];
        let mut frame = [&[0], &body[..], &crc::checksum(&body).to_le_bytes(), &[0]].concat();
        let end = frame.len() - 1;
        cobs::stuff(&mut frame[..end]);
        assert_eq!(read_quickly::<DriveMessage>(&frame), None, "state 9");
        assert_eq!(read_quickly::<HostMessage>(&frame), None, "the other direction");
    }
}
