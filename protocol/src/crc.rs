//! The check value of a frame: CRC-32/ISCSI, also called CRC-32C (Castagnoli).
//!
//! Chosen for the errors it is sure to see. Body and CRC of a torque answer are 14 bytes, of an encoder sample 17; up to
//! 209 bits this polynomial has Hamming distance 8, so any seven flipped bits among them are found. In the longest
//! frame (61 bytes) any five are (distance 6 up to 5,275 bits; Koopman 2002, and a test here proves both for our lengths).
//! The CRC-16 polynomials reach only distance 4 to 6 at these lengths and let one random frame in 65,536 through; for two
//! bytes more it is one in four thousand million, and no damaged byte is to move a motor.
//!
//! What is sure for the body is only likely for the line: a bit flipped in a stuffing byte moves zeros about and changes
//! several bits of the body at once, and such a frame passes with the odds of a random one, 2^-32.
//!
//! | | |
//! |---|---|
//! | polynomial | `0x1edc6f41`, reflected in and out |
//! | initial value, final xor | `0xffffffff`, `0xffffffff` |
//! | check value (`"123456789"`) | `0xe3069283` |

use crc::{CRC_32_ISCSI, Crc, Table};

/// Number of bytes.
pub const LEN: usize = 4;

/// A PC takes up to sixteen bytes at a time from 16 KiB of tables; a microcontroller keeps its flash.
#[cfg(feature = "fast-path")]
type Tables = Table<16>;
#[cfg(not(feature = "fast-path"))]
type Tables = Table<1>;

static CRC: Crc<u32, Tables> = Crc::<u32, Tables>::new(&CRC_32_ISCSI);

/// The check value of a body.
#[cfg(not(feature = "fast-path"))]
#[inline]
#[must_use]
pub fn checksum(body: &[u8]) -> u32 {
    CRC.checksum(body)
}

/// The check value of a body.
///
/// `Crc::checksum` takes sixteen bytes in one step but what is left of them one after the other, each waiting for the
/// one before: most of a torque answer. Here only the bytes before the first whole word are taken one by one.
#[cfg(feature = "fast-path")]
#[inline(always)]
#[must_use]
pub fn checksum(body: &[u8]) -> u32 {
    /// Words in a step.
    const BLOCK: usize = 4;
    let (first, words) = body.as_rchunks();
    let mut crc = u32::MAX;
    for byte in first {
        crc = CRC.table()[0][usize::from(crc as u8 ^ byte)] ^ crc >> 8;
    }
    let (few, blocks) = words.split_at(words.len() % BLOCK);
    if !few.is_empty() {
        crc = step(crc, few);
    }
    for block in blocks.chunks_exact(BLOCK) {
        crc = step(crc, block);
    }
    !crc
}

/// The CRC after up to four more words.
///
/// In table `n` stands what a byte has become `n` bytes later, and as the CRC is linear, these add up.
#[cfg(feature = "fast-path")]
#[inline(always)]
fn step(before: u32, words: &[[u8; LEN]]) -> u32 {
    let mut crc = 0;
    let mut later = words.len() * LEN;
    for (at, word) in words.iter().enumerate() {
        let carried = if at == 0 { before } else { 0 };
        for byte in (u32::from_le_bytes(*word) ^ carried).to_le_bytes() {
            later -= 1;
            crc ^= CRC.table()[later][usize::from(byte)];
        }
    }
    crc
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use super::*;
    use crate::message::{DriveMessage, HostMessage, Message};

    #[test]
    fn the_check_value_is_the_catalogue_s() {
        assert_eq!(checksum(b"123456789"), 0xe306_9283);
    }

    #[test]
    fn every_length_gives_the_check_value_of_the_crc_crate() {
        let bytes: Vec<u8> = (0..100_u8).map(|i| i.wrapping_mul(167) ^ 0x5a).collect();
        for len in 0..=bytes.len() {
            assert_eq!(checksum(&bytes[..len]), CRC.checksum(&bytes[..len]), "{len} bytes");
        }
    }

    /// What flipping one bit of a body followed by its CRC does to the remainder, for every bit.
    ///
    /// The CRC is affine, so an error pattern goes unseen exactly if the syndromes of its bits cancel.
    fn syndromes(body_len: usize) -> Vec<u32> {
        let mut body = std::vec![0_u8; body_len];
        let clean = checksum(&body);
        let mut syndromes: Vec<u32> = (0..32).map(|bit| 1 << bit).collect();
        for bit in 0..body_len * 8 {
            body[bit / 8] ^= 1 << (bit % 8);
            syndromes.push(checksum(&body) ^ clean);
            body[bit / 8] ^= 1 << (bit % 8);
        }
        syndromes
    }

    fn all_differ(mut values: Vec<u32>) -> bool {
        let count = values.len();
        values.sort_unstable();
        values.dedup();
        values.len() == count
    }

    /// Sums of two different syndromes.
    fn pairs(s: &[u32]) -> Vec<u32> {
        (0..s.len()).flat_map(|i| (0..i).map(move |j| s[i] ^ s[j])).collect()
    }

    fn triples(s: &[u32]) -> Vec<u32> {
        (0..s.len()).flat_map(|i| (0..i).flat_map(move |j| (0..j).map(move |k| s[i] ^ s[j] ^ s[k]))).collect()
    }

    /// A pattern of odd weight never cancels, because the polynomial has the factor x + 1: every syndrome then has
    /// odd parity under one fixed mask. We look for that mask's effect by brute force instead of trusting it.
    fn odd_weights_are_seen(s: &[u32]) -> bool {
        // Solve for m with parity(s & m) = 1 for all s; over the 32 unit syndromes m is all ones.
        s.iter().all(|x| x.count_ones() % 2 == 1)
    }

    #[test]
    fn any_seven_flipped_bits_of_a_sample_s_or_a_torque_s_body_are_found() {
        for name in ["EncoderSample", "TorqueAnswer"] {
            let layout = HostMessage::LAYOUTS.iter().chain(DriveMessage::LAYOUTS).find(|l| l.name == name);
            let s = syndromes(layout.unwrap().body_len);
            // Two different triples with one sum would be an unseen pattern of weight 2, 4 or 6.
            assert!(all_differ(triples(&s)) && odd_weights_are_seen(&s), "{name}");
        }
    }

    #[test]
    fn any_five_flipped_bits_of_the_longest_body_are_found() {
        let s = syndromes(crate::MAX_BODY);
        assert!(all_differ(pairs(&s)) && odd_weights_are_seen(&s));
    }
}
