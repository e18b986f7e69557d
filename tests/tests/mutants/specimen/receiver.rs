//! Bytes to bodies and back: section 2 of the page.

use crate::mutation::Sites;

const LONGEST: i64 = 63;
/// A code byte, a kind and a CRC.
const SHORTEST: usize = 6;
/// A pause that a receiver with a timeout would take for the end of a frame.
const PAUSE_US: f64 = 2_000.0;

/// A receiver between two delimiters.
#[derive(Default)]
pub struct Receiver {
    bytes: Vec<u8>,
    has_overflowed: bool,
    last_us: f64,
}

/// The CRC of section 2, bit by bit.
fn crc(body: &[u8]) -> u32 {
    let step = |crc: u32, _| crc >> 1 ^ if crc & 1 == 1 { 0x82f6_3b78 } else { 0 };
    !body.iter().fold(u32::MAX, |crc, byte| (0..8).fold(crc ^ u32::from(*byte), step))
}

/// The frame of a body.
pub fn frame(at: &Sites, body: &[u8]) -> Vec<u8> {
    let crc = match at.pick("frame", "CRC", 0, &[0, 1, 2, 3]) {
        0 => crc(body),
        1 => !crc(body),
        2 => crc(body).swap_bytes(),
        _ => crc(&body[1..]),
    };
    let plain = [body, &crc.to_le_bytes()].concat();
    let mut frame = Vec::new();
    for part in plain.split(|byte| *byte == 0) {
        frame.push(part.len() as u8 + 1);
        frame.extend(part);
    }
    let delimiters = at.pick("frame", "delimiters", 1, &[0, 1, 2]);
    frame.resize(frame.len() + delimiters, 0);
    frame
}

impl Receiver {
    /// Takes a byte; at a delimiter the frame before it, `Err` if it is damaged.
    pub fn take(&mut self, at: &Sites, byte: u8, now_us: f64) -> Option<Result<Vec<u8>, ()>> {
        let pause_us = now_us - std::mem::replace(&mut self.last_us, now_us);
        if at.flag("receiver", "a pause ends a frame", false) && pause_us > PAUSE_US {
            self.bytes.clear();
        }
        if byte != 0 {
            self.keep(at, byte);
            return None;
        }
        let bytes = std::mem::take(&mut self.bytes);
        let has_overflowed = std::mem::take(&mut self.has_overflowed);
        if at.flag("receiver", "a delimiter without a byte before it isn't a frame", bytes.is_empty()) {
            return None;
        }
        if at.flag("receiver", "too long is damaged", has_overflowed) {
            return Some(Err(()));
        }
        Some(unstuffed(at, &bytes).and_then(|plain| checked(at, &plain)))
    }

    fn keep(&mut self, at: &Sites, byte: u8) {
        if (self.bytes.len() as i64) < at.whole("receiver", "longest frame", LONGEST) {
            self.bytes.push(byte);
            return;
        }
        // Of the bytes beyond, a receiver may mistake the last ones for a frame of their own.
        self.has_overflowed = at.flag("receiver", "the rest of a too long frame is dropped", true);
        if !self.has_overflowed {
            self.bytes.clear();
        }
    }
}

fn unstuffed(at: &Sites, bytes: &[u8]) -> Result<Vec<u8>, ()> {
    if at.flag("receiver", "too short is damaged", bytes.len() < SHORTEST) {
        return Err(());
    }
    let mut plain = Vec::new();
    let mut code_at = 0;
    while code_at < bytes.len() {
        let next = code_at + usize::from(bytes[code_at]);
        if at.flag("receiver", "a distance beyond the delimiter is damage", next > bytes.len()) {
            return Err(());
        }
        plain.extend(bytes.get(code_at + 1..next.min(bytes.len())).unwrap_or_default());
        if next < bytes.len() {
            plain.push(0);
        }
        code_at = next;
    }
    Ok(plain)
}

fn checked(at: &Sites, plain: &[u8]) -> Result<Vec<u8>, ()> {
    let Some((body, sent)) = plain.split_last_chunk::<4>() else { return Err(()) };
    let sent = u32::from_le_bytes(*sent);
    let sent = at.pick("receiver", "byte order of the CRC", sent, &[sent, sent.swap_bytes()]);
    // Which bits differ, as mutants compare some of them only.
    let differs = sent ^ crc(body);
    let masks = [u32::MAX, 0xffff, 0xffff_0000, 0xff];
    let mask = at.pick("receiver", "bits of the CRC", u32::MAX, &masks);
    if at.flag("receiver", "another CRC is damage", differs & mask != 0) {
        return Err(());
    }
    Ok(body.to_vec())
}
