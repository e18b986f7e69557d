//! Damaged copies of good frames: flipped bits, other checksums, bad stuffing.

use lashloop_protocol::{cobs, crc};

use crate::prelude::wire::*;

/// CRC-32/ISCSI and CRC-32/ISO-HDLC, reflected.
const POLYNOMIALS: [u32; 2] = [0x82f6_3b78, 0xedb8_8320];

/// The body of a good frame.
pub(super) fn body(frame: &[u8]) -> Vec<u8> {
    let mut stuffed = frame[..frame.len() - 1].to_vec();
    let open = cobs::unstuff(&mut stuffed).unwrap_or_default();
    open[..open.len().saturating_sub(crc::LEN)].to_vec()
}

/// Any bytes, stuffed and with a delimiter.
pub(super) fn stuffed(bytes: &[u8]) -> Vec<u8> {
    let mut frame = [&[0], bytes].concat();
    cobs::stuff(&mut frame);
    frame.push(DELIMITER);
    frame
}

/// A copy for every bit of every byte but the delimiter. A flip that makes a delimiter is left out, because it makes two
/// frames.
pub(super) fn flipped_bits(frame: &[u8]) -> Vec<Vec<u8>> {
    let places = (0..frame.len() - 1).flat_map(|place| (0..u8::BITS).map(move |bit| (place, 1 << bit)));
    let kept = places.filter(|(place, mask)| frame[*place] ^ mask != DELIMITER);
    kept.map(|(place, mask)| {
        let mut copy = frame.to_vec();
        copy[place] ^= mask;
        copy
    })
    .collect()
}

/// Frames around a body with checksums of other rules, and with none.
pub(super) fn checksums(body: &[u8]) -> Vec<Vec<u8>> {
    let good = crc::checksum(body);
    let mut others = vec![good.swap_bytes(), good.rotate_left(8), good ^ 1, good ^ 1 << 31, 0, u32::MAX];
    for polynomial in POLYNOMIALS {
        for initial in [u32::MAX, 0] {
            let checksum = remainder(polynomial, initial, body);
            others.extend([checksum, !checksum]);
        }
    }
    // Over the fields without the kind, and over the body with a byte more.
    others.extend([crc::checksum(&body[1..]), crc::checksum(&[body, &[0]].concat())]);
    others.retain(|checksum| *checksum != good);
    others.sort_unstable();
    others.dedup();
    others.iter().map(|checksum| stuffed(&[body, &checksum.to_le_bytes()].concat())).collect()
}

/// The register after `body`, shifted to the right.
fn remainder(polynomial: u32, initial: u32, body: &[u8]) -> u32 {
    body.iter().fold(initial, |register, byte| {
        (0..u8::BITS).fold(register ^ u32::from(*byte), |register, _| {
            register >> 1 ^ if register & 1 == 1 { polynomial } else { 0 }
        })
    })
}

/// Copies whose chain of distances does not end at the delimiter, and frames of fewer than 6 bytes.
pub(super) fn stuffing(frame: &[u8]) -> Vec<Vec<u8>> {
    let mut frames = Vec::new();
    for code in [frame[0].wrapping_add(1), 63, 64, 128, 254, 255] {
        let mut copy = frame.to_vec();
        copy[0] = code;
        frames.push(copy);
    }
    // The last distance points beyond the delimiter, or short of it.
    let last = frame.len() - 1;
    frames.push([&frame[..last - 1], &[DELIMITER]].concat());
    frames.push([&frame[..last], &[1, DELIMITER]].concat());
    // Whole, but too short: the last is a body of no byte with its checksum, which is zero.
    let short: [&[u8]; 5] = [&[1], &[2, 1], &[4, 1, 1, 1], &[2], &[1, 1, 1, 1, 1]];
    frames.extend(short.map(|bytes| [bytes, &[DELIMITER]].concat()));
    frames
}

#[cfg(test)]
mod tests {
    use super::*;
    use lashloop_protocol::message::{EncoderSample, GetParameter, Stop};
    use lashloop_protocol::{Decoder, EncoderCounts, HostMessage, Message};

    fn requests() -> [HostMessage; 3] {
        let [motor_counts, load_counts] = [EncoderCounts::default(); 2];
        let sample = EncoderSample { sequence: 0, motor_counts, load_counts, reference_rad: 1.0 };
        [GetParameter { index: 0 }.into(), Stop {}.into(), sample.into()]
    }

    #[test]
    fn every_damaged_copy_is_damaged_once() {
        for request in requests() {
            let frame = request.frame();
            let copies = [flipped_bits(&frame), checksums(&body(&frame)), stuffing(&frame)].concat();
            for copy in copies {
                let mut decoder = Decoder::new();
                let mut bytes = &copy[..];
                while let Some(decoded) = decoder.next::<HostMessage>(&mut bytes) {
                    decoded.expect_err("a damaged frame");
                }
                assert_eq!((decoder.counters().damaged(), decoder.counters().refused), (1, 0), "{copy:02x?}");
            }
        }
    }

    #[test]
    fn the_body_of_a_frame_is_framed_alike() {
        for request in requests() {
            let frame = request.frame();
            let body = body(&frame);
            let again = stuffed(&[&body[..], &crc::checksum(&body).to_le_bytes()].concat());
            assert_eq!(again, frame.to_vec());
        }
    }
}
