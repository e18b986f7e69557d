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
const LINKS_AT_ONCE: usize = 6;

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
    if frame[1] != P::LAYOUT.kind || cobs::find_zero(frame) != Some(crc_end) {
        return None;
    }
    let links = chain(frame)?;
    // Not the byte found, which may have been a zero: then it is a link, and the CRC won't be right.
    let mut plain = [0; ROOM];
    plain[1] = P::LAYOUT.kind;
    let mut at = FIELDS;
    while at < crc_end {
        put_word(&mut plain, at, word_at(frame, at) & KEPT[usize::from((links >> at) as u8)]);
        at += WORD;
    }
    let body = &plain[1..body_end];
    let good = frame[0] != 1 && plain[body_end..].starts_with(&crc::checksum(body).to_le_bytes());
    if good { Some((P::get(body).ok()?, rest)) } else { None }
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

/// The chain of distances in `frame`, which ends with its delimiter: bit `n` is set if byte `n` is a link. `None` if it
/// doesn't end at the delimiter.
///
/// There it stays, at a distance of zero, which is why it may be followed too far.
#[inline(always)]
fn chain(frame: &[u8]) -> Option<u64> {
    let end = frame.len() - 1;
    let (mut at, mut links) = (0, 0);
    while at < end {
        for _ in 0..LINKS_AT_ONCE {
            links |= 1_u64 << at;
            at += usize::from(*frame.get(at)?);
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
