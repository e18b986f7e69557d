//! The check value of a frame: CRC-32/ISCSI, also called CRC-32C (Castagnoli).
//!
//! Body and CRC of a torque answer are 14 bytes, of an encoder sample 17. Up to 209 bits the polynomial has Hamming distance 8:
//! any seven flipped bits are detected. In the longest frame (61 bytes) any five are, as the distance is 6 up to 5,275 bits
//! (Koopman 2002; the tests prove both for our lengths).
//!
//! We chose 32 bits because a damaged frame must not move a motor. The CRC-16 polynomials reach distance 4 to 6 at these lengths
//! and pass one random frame in 65,536; two more bytes reduce that to one in 2^32.
//!
//! The distance holds for errors in the body. A flipped bit in a COBS code byte displaces zeros and changes several bits of the
//! body at once; such a frame passes with the probability of a random one, 2^-32.
//!
//! | | |
//! |---|---|
//! | polynomial | `0x1edc6f41`, reflected in and out |
//! | initial value, final xor | `0xffffffff`, `0xffffffff` |
//! | check value (`"123456789"`) | `0xe3069283` |

use crc::{CRC_32_ISCSI, Crc, Table};

pub use crate::limits::CRC_LEN as LEN;

/// 16 KiB of tables on a PC, for sixteen bytes per step; 1 KiB on a microcontroller, to save flash.
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
/// `Crc::checksum` processes blocks of sixteen bytes in one step, but the remaining bytes, most of a torque answer, one by one
/// with a dependency between them. This function processes only the bytes before the first whole word one by one.
#[cfg(feature = "fast-path")]
#[inline(always)]
#[must_use]
pub fn checksum(body: &[u8]) -> u32 {
    /// Words per step.
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
/// Table `n` holds the contribution of a byte `n` bytes later. The CRC is linear, so the contributions add up.
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

    #[test]
    fn the_check_value_is_that_of_the_catalogue() {
        assert_eq!(checksum(b"123456789"), 0xe306_9283);
    }

    #[test]
    fn every_length_agrees_with_the_crc_crate() {
        let bytes: Vec<u8> = (0..100_u8).map(|i| i.wrapping_mul(167) ^ 0x5a).collect();
        for len in 0..=bytes.len() {
            assert_eq!(checksum(&bytes[..len]), CRC.checksum(&bytes[..len]), "{len} bytes");
        }
    }
}
