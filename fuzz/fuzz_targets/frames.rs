//! The decoder agrees with its specification on frames whose CRC is correct, whole or damaged.
//!
//! The first byte is as that of `decoder`. The rest is frames: the length of the body, a damage, the body. The lowest bits of the
//! length count modulo the longest body; its two highest bits choose the damage.

#![no_main]

use lashloop_protocol::frame::MAX_BODY;
use lashloop_protocol::{DriveMessage, HostMessage, MAX_FRAME, cobs, crc};
use libfuzzer_sys::fuzz_target;

mod oracle;

const CAPACITY: usize = 512;

fuzz_target!(|input: &[u8]| {
    let Some((&first, mut rest)) = input.split_first() else { return };
    let (mut stream, mut len) = ([0; CAPACITY], 0);
    while let Some(([head, damage], after)) = rest.split_first_chunk() {
        if len + MAX_FRAME > CAPACITY {
            break;
        }
        let body_len = (usize::from(head & 0x3f) % MAX_BODY + 1).min(after.len());
        let (body, after) = after.split_at(body_len);
        rest = after;
        let at = usize::from(*damage);
        let frame = &mut stream[len..];
        let whole = frame_around(body, frame);
        len += match head >> 6 {
            // A bit flipped.
            1 => {
                frame[at / 8 % whole] ^= 1 << (at % 8);
                whole
            }
            // The end is missing, so that the next frame follows without a delimiter.
            2 => at % whole,
            _ => whole,
        };
    }
    let (stream, piece_len) = (&stream[..len], usize::from(first & 0x7f));
    if first & 0x80 == 0 {
        oracle::check::<HostMessage>(stream, piece_len);
    } else {
        oracle::check::<DriveMessage>(stream, piece_len);
    }
});

/// Writes the frame around a body, and returns its length.
fn frame_around(body: &[u8], out: &mut [u8]) -> usize {
    let crc_at = 1 + body.len();
    let end = crc_at + crc::LEN;
    out[1..crc_at].copy_from_slice(body);
    out[crc_at..end].copy_from_slice(&crc::checksum(body).to_le_bytes());
    cobs::stuff(&mut out[..end]);
    out[end] = 0;
    end + 1
}
