//! A faster path on a PC for the one message of each direction that is sent in every control period.
//!
//! The bytes are those of [`crate::frame::write`] and [`crate::frame::open`], the general path of microcontrollers and of all other
//! messages. The gain comes from:
//!
//! - constant lengths: the kind is known, so no loop runs over bytes;
//! - registers: kind to delimiter stay in two words. Bytes written one by one and read as a word would stall on store forwarding;
//! - no unpredictable branch: zeros occur anywhere, and a misprediction costs more than the rest. The writer takes the distances of
//!   a word from a table. The reader follows the chain and branches only from the second zero on.

mod swar;

use swar::WORD;

use crate::crc;
use crate::limits::{DELIMITER, MAX_FRAME};
use crate::wire::Payload;

/// Offset of the fields, after code and kind.
const FIELDS: usize = 2;
/// Bytes after the kind that two words hold.
const TAIL: usize = size_of::<u128>();

/// Length of fields and CRC, in bytes.
const fn tail_len<P: Payload>() -> usize {
    let len = P::LAYOUT.body_len - 1 + crc::LEN;
    assert!(WORD < len && len <= TAIL, "fields and CRC of a periodic message need two words");
    assert!(!P::LAYOUT.has_number(), "a periodic message has no number");
    len
}

/// Length of the fields, in bits.
const fn fields_bits<P: Payload>() -> usize {
    8 * (P::LAYOUT.body_len - 1)
}

/// Writes the frame of a message to the beginning of `buffer`.
#[inline(always)]
pub(crate) fn write<'buffer, P: Payload>(payload: &P, buffer: &'buffer mut [u8; MAX_FRAME]) -> &'buffer [u8] {
    let len = const { tail_len::<P>() };
    let fields = fields(payload);
    let tail = fields | u128::from(checksum::<P>(fields)) << fields_bits::<P>();
    let (first, [low, high]) = swar::with_distances([tail as u64, (tail >> u64::BITS) as u64]);

    buffer[0] = (FIELDS + first) as u8;
    buffer[1] = P::LAYOUT.kind;
    buffer[FIELDS..][..WORD].copy_from_slice(&low.to_le_bytes());
    buffer[FIELDS + WORD..][..WORD].copy_from_slice(&high.to_le_bytes());
    buffer[FIELDS + len] = DELIMITER;
    &buffer[..=FIELDS + len]
}

/// The message at the beginning of `input`, and the remaining input; `None` unless `input` begins with a whole and correct frame
/// of this kind.
#[inline(always)]
pub(crate) fn split_off<P: Payload>(input: &[u8]) -> Option<(P, &[u8])> {
    let len = const { tail_len::<P>() };
    let (frame, rest) = input.split_at_checked(FIELDS + len + 1)?;
    let (&delimiter, stuffed) = frame.split_last()?;
    // With a first distance of 1 the kind byte is a link and stands for a zero, although its value matches.
    if stuffed[0] <= 1 || stuffed[1] != P::LAYOUT.kind || delimiter != DELIMITER {
        return None;
    }
    // The last word overlaps the first.
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

/// The fields as one number, the first field in its lowest bytes.
///
/// Each field is read with the width of its write, so the compiler keeps all fields in registers.
#[inline(always)]
fn fields<P: Payload>(payload: &P) -> u128 {
    let mut body = [0; 1 + TAIL];
    payload.put(0, &mut body[..P::LAYOUT.body_len]);
    let mut fields = 0;
    for field in P::LAYOUT.fields {
        let mut word = [0; TAIL];
        word[..field.len].copy_from_slice(&body[field.offset..field.offset + field.len]);
        fields |= u128::from_le_bytes(word) << (8 * (field.offset - 1));
    }
    fields
}

/// The kind, followed by the tail.
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

/// The chain of distances in `frame`, whose last byte is the delimiter and the only zero; `None` if the chain doesn't end at the
/// delimiter. Bit `n` is set if byte `n` is a link; the code byte, which always is a link, is omitted.
///
/// The first link is followed without a test. In a frame without zeros it is the delimiter, whose distance of zero ends the chain.
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

    /// Samples with zeros in every subset of their 12 bytes.
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

    /// Torques with zeros in every subset of their bytes, except for the status, whose state is never zero.
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

    /// The bytes up to the first delimiter, decoded on the general path.
    fn read_on_the_general_path<M: Message>(line: &[u8]) -> Option<(Vec<u8>, usize)> {
        let end = cobs::find_zero(line)?;
        let mut stuffed = line[..end].to_vec();
        let message = M::decode_body(crate::frame::open(&mut stuffed).ok()?).ok()?.message;
        Some((message.frame().to_vec(), line.len() - end - 1))
    }

    /// As bytes, because a reference may be NaN, which is unequal to itself.
    fn read_on_the_fast_path<M: Message>(line: &[u8]) -> Option<(Vec<u8>, usize)> {
        M::split_off_periodic(line).map(|(message, rest)| (message.frame().to_vec(), rest.len()))
    }

    fn both_paths_read_back<M: Message>(message: &M) {
        let line = [&message.frame()[..], &[7, 0]].concat();
        let want = Some((message.frame().to_vec(), 2));
        assert_eq!(read_on_the_fast_path::<M>(&line), want);
        assert_eq!(read_on_the_general_path::<M>(&line), want);
    }

    /// Into a buffer with other contents, because the sender of a frame need not clear it.
    fn both_paths_write(message: &(impl Message + std::fmt::Debug), general: &[u8]) {
        assert_eq!(message.write_frame(&mut [0x55; MAX_FRAME]), general, "{message:?}");
        assert_eq!(message.frame()[..], *general, "{message:?}");
    }

    #[test]
    fn both_paths_agree_wherever_zeros_are() {
        for sample in samples() {
            both_paths_write(&sample, sample.write_frame_of_any_kind(0, &mut [0x55; MAX_FRAME]));
            both_paths_read_back(&sample);
        }
        for torque in torques() {
            both_paths_write(&torque, torque.write_frame_of_any_kind(0, &mut [0x55; MAX_FRAME]));
            both_paths_read_back(&torque);
        }
    }

    /// Every byte of the frame replaced by every other value, and the frame truncated at every length.
    fn paths_agree_on_a_wrong_byte<M: Message>(message: &M) {
        let frame = message.frame();
        for at in 0..frame.len() {
            for byte in 0..=u8::MAX {
                let mut line = [&frame[..], &[7, 0]].concat();
                line[at] = byte;
                assert_eq!(
                    read_on_the_fast_path::<M>(&line),
                    read_on_the_general_path::<M>(&line),
                    "{line:02x?}"
                );
            }
            assert_eq!(read_on_the_fast_path::<M>(&frame[..at]), None, "truncated to {at} bytes");
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
    fn both_paths_agree_on_a_wrong_byte() {
        samples().step_by(171).for_each(|sample| paths_agree_on_a_wrong_byte(&sample));
        // The first link is 17 bytes further. A first distance damaged into 1 makes the kind 0x10 a link to the same byte, and
        // everything but the kind is unchanged.
        paths_agree_on_a_wrong_byte(&sample_whose_first_zero_is_the_last_byte_of_its_crc());
        torques().step_by(65).for_each(|torque| paths_agree_on_a_wrong_byte(&torque));
    }

    #[test]
    fn a_zero_outside_the_chain_ends_the_frame() {
        for message in samples().step_by(251) {
            let good = message.frame();
            let end = good.len() - 1;
            let links = chain(&good).expect("a chain") | 1;
            for at in (FIELDS..end).filter(|at| links >> at & 1 == 1) {
                // The previous link skips this one: the body would be the same, and its CRC correct.
                let before = (0..at).rfind(|before| links >> before & 1 == 1).expect("the code byte");
                let mut frame = good.to_vec();
                frame[before] += frame[at];
                frame[at] = 0;
                assert_eq!(read_on_the_fast_path::<HostMessage>(&frame), None, "{frame:02x?}");
            }
        }
    }

    #[test]
    fn a_correct_crc_alone_does_not_make_a_message() {
        let body = [0x90, 1, 2, 3, 4, 5, 6, 0x40, 0, 0];
        let mut frame = [&[0], &body[..], &crc::checksum(&body).to_le_bytes(), &[0]].concat();
        let end = frame.len() - 1;
        cobs::stuff(&mut frame[..end]);
        assert_eq!(read_on_the_fast_path::<DriveMessage>(&frame), None, "state 0");
        assert_eq!(read_on_the_fast_path::<HostMessage>(&frame), None, "the other direction");
    }
}
