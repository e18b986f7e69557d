//! The Hamming distance of the CRC at the lengths of our frames.

use lashloop_protocol::crc::checksum;
use lashloop_protocol::{DriveMessage, HostMessage, MAX_BODY, Message};

/// The change of the remainder by a flip of each bit of a body with its CRC.
///
/// The CRC is affine: an error pattern is undetected exactly if the syndromes of its bits cancel.
fn syndromes(body_len: usize) -> Vec<u32> {
    let mut body = vec![0_u8; body_len];
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

/// Sums of three different syndromes.
fn triples(s: &[u32]) -> Vec<u32> {
    (0..s.len()).flat_map(|i| (0..i).flat_map(move |j| (0..j).map(move |k| s[i] ^ s[j] ^ s[k]))).collect()
}

/// Whether every error pattern of odd weight is detected: the polynomial has the factor x + 1, so every syndrome has odd
/// parity. We check the parity instead of relying on the factor.
fn odd_weights_are_detected(s: &[u32]) -> bool {
    s.iter().all(|x| x.count_ones() % 2 == 1)
}

#[test]
fn seven_flipped_bits_of_a_periodic_message_are_detected() {
    for name in ["EncoderSample", "TorqueAnswer"] {
        let layout = HostMessage::LAYOUTS.iter().chain(DriveMessage::LAYOUTS).find(|l| l.name == name);
        let s = syndromes(layout.unwrap().body_len);
        // Two different triples with one sum would be an undetected pattern of weight 2, 4 or 6.
        assert!(all_differ(triples(&s)) && odd_weights_are_detected(&s), "{name}");
    }
}

#[test]
fn five_flipped_bits_of_the_longest_body_are_detected() {
    let s = syndromes(MAX_BODY);
    assert!(all_differ(pairs(&s)) && odd_weights_are_detected(&s));
}
