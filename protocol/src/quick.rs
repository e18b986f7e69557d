//! How a PC writes and reads the one message of each direction that is sent in every control period.
//!
//! The bytes are those of [`Frame::of`] and [`crate::frame::open`], which a microcontroller uses for every message and a
//! PC for all others. What makes the difference:
//!
//! - The kind is known, so lengths are constants, nothing loops over bytes, and the body stays in registers.
//! - The chain of distances is followed and laid for a fixed number of links: how many zeros a body has is beyond any
//!   processor's guess, and a wrong guess costs more than the links that were not needed.
//! - Words begin behind the kind byte, where fields of four bytes lie whole in them: a word that is read after its
//!   bytes were written one by one has to wait for them.

use crate::frame::{Frame, MAX_FRAME};
use crate::wire::Payload;
use crate::{cobs, crc};

/// Links of the chain that are taken without asking whether there are more: as many zeros and one.
const LINKS_AT_ONCE: usize = 5;

/// Where the fields begin.
const FIELDS: usize = 2;
/// Bytes in a word.
const WORD: usize = size_of::<u64>();
/// Room for a frame whose last word is whole.
const ROOM: usize = FIELDS + MAX_FRAME;

/// The frame of a message.
#[inline(always)]
pub(crate) fn frame<P: Payload>(payload: &P) -> Frame {
    let body_end = 1 + P::LAYOUT.body_len;
    let crc_end = body_end + crc::LEN;
    let mut plain = [0; ROOM];
    payload.put(&mut plain[1..body_end]);
    let checksum = crc::checksum(&plain[1..body_end]);
    plain[body_end..crc_end].copy_from_slice(&checksum.to_le_bytes());

    let mut zeros = 0;
    let mut bytes = [0; MAX_FRAME];
    bytes[..FIELDS].copy_from_slice(&plain[..FIELDS]);
    let mut at = FIELDS;
    while at < crc_end {
        let word = word_at(&plain, at);
        zeros |= u64::from(zeros_of(word)) << at;
        put_word(&mut bytes, at, word);
        at += WORD;
    }
    lay_chain(&mut bytes, zeros, crc_end);
    Frame::from_parts(bytes, crc_end + 1)
}

/// The message at the beginning of `input`, and what comes after it; `None` if there is no whole and good frame of this
/// kind, whatever there is instead.
#[inline(always)]
pub(crate) fn split_off<P: Payload>(input: &[u8]) -> Option<(P, &[u8])> {
    let body_end = 1 + P::LAYOUT.body_len;
    let crc_end = body_end + crc::LEN;
    let (frame, rest) = input.split_at_checked(crc_end + 1)?;
    // With a first distance of 1 the kind byte is a link: it looks right but stands for a zero.
    if frame[0] == 1 || frame[1] != P::LAYOUT.kind || cobs::find_zero(frame) != Some(crc_end) {
        return None;
    }
    let links = chain(frame)?;
    let mut plain = [0; ROOM];
    plain[1] = P::LAYOUT.kind;
    let mut at = FIELDS;
    while at < crc_end {
        put_word(&mut plain, at, word_at(frame, at) & KEPT[usize::from((links >> at) as u8)]);
        at += WORD;
    }
    let body = &plain[1..body_end];
    if !plain[body_end..].starts_with(&crc::checksum(body).to_le_bytes()) {
        return None;
    }
    Some((P::get(body).ok()?, rest))
}

/// The word that begins at `at`, with zeros for what lies behind the end.
#[inline(always)]
fn word_at(bytes: &[u8], at: usize) -> u64 {
    let mut word = [0; WORD];
    let len = WORD.min(bytes.len() - at);
    word[..len].copy_from_slice(&bytes[at..at + len]);
    u64::from_le_bytes(word)
}

/// Puts a word, as much of it as there is room for.
#[inline(always)]
fn put_word(bytes: &mut [u8], at: usize, word: u64) {
    let len = WORD.min(bytes.len() - at);
    bytes[at..at + len].copy_from_slice(&word.to_le_bytes()[..len]);
}

/// The chain of distances in `frame`, whose last byte is the delimiter and the only zero: bit `n` is set if byte `n` is a
/// link. `None` if the chain doesn't end at the delimiter.
///
/// There it stays, at a distance of zero, which is why it may be followed too far.
#[inline(always)]
fn chain(frame: &[u8]) -> Option<u64> {
    let end = frame.len() - 1;
    let (mut at, mut links) = (0, 0);
    while at < end {
        for _ in 0..LINKS_AT_ONCE {
            let distance = *frame.get(at)?;
            links |= 1_u64 << at;
            at += usize::from(distance);
        }
    }
    (at == end).then_some(links)
}

/// Writes the distances into the bytes whose bit is set in `zeros`, and into the first.
#[inline(always)]
fn lay_chain(frame: &mut [u8; MAX_FRAME], zeros: u64, end: usize) {
    let delimiter = 1 << end;
    let mut to_come = zeros & (delimiter - 1);
    let mut at = 0;
    while at < end {
        for _ in 0..LINKS_AT_ONCE {
            // From the delimiter on the distance is zero, which is what the delimiter is.
            let next = (to_come | delimiter).trailing_zeros() as usize;
            frame[at] = (next - at) as u8;
            at = next;
            to_come &= to_come.wrapping_sub(1);
        }
    }
}

/// Bit `n` is set if byte `n` of the word is zero.
#[inline(always)]
fn zeros_of(word: u64) -> u8 {
    const LOW_BITS: u64 = u64::from_ne_bytes([0x7f; WORD]);
    // The highest bit of each byte, set unless all eight are zero; no sum carries into the next byte.
    let others = ((word & LOW_BITS) + LOW_BITS) | word | LOW_BITS;
    // Its complement, gathered in the highest byte.
    ((!others >> 7).wrapping_mul(0x0102_0408_1020_4080) >> 56) as u8
}

/// For each set of bytes in a word, by their bits, a mask that clears them.
static KEPT: [u64; 256] = {
    let mut masks = [u64::MAX; 256];
    let mut set = 0;
    while set < masks.len() {
        let mut byte = 0;
        while byte < WORD {
            if set >> byte & 1 == 1 {
                masks[set] &= !(0xff << (8 * byte));
            }
            byte += 1;
        }
        set += 1;
    }
    masks
};

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use super::*;
    use crate::counts::EncoderCounts;
    use crate::message::{DriveMessage, EncoderSample, HostMessage, Message, TorqueAnswer};
    use crate::vocabulary::{State, TorqueFlags, TorqueStatus};

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

    #[test]
    fn wherever_zeros_are_the_frame_is_that_of_the_long_way() {
        for sample in samples() {
            assert_eq!(sample.frame()[..], sample.frame_of_any_kind()[..], "{sample:?}");
            comes_back(&sample);
        }
        for torque in torques() {
            assert_eq!(torque.frame()[..], torque.frame_of_any_kind()[..], "{torque:?}");
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
            let links = chain(&good).expect("a chain");
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
