//! An FT232R as Linux's `ftdi_sio` knows it, after FTDI's AN232B-04 and AN232B-05: requests by number, two bytes of status
//! at the head of each packet, a latency timer, and a wire that takes its time for each byte.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use usb_device::UsbDirection;

use super::urb::{Completion, Urb};

const PACKET: usize = 64;
/// Modem status and line status: all modem lines on, transmitter empty.
const STATUS: [u8; 2] = [0x01, 0x60];
const PAYLOAD: usize = PACKET - STATUS.len();
/// The timer after power-up.
const DEFAULT_LATENCY: Duration = Duration::from_millis(16);

const DEVICE: [u8; 18] = [18, 1, 0x00, 0x02, 0, 0, 0, 8, 0x03, 0x04, 0x01, 0x60, 0x00, 0x06, 1, 2, 3, 1];
/// One interface of the vendor's class with a bulk endpoint each way.
const CONFIGURATION: [u8; 32] = [
    9, 2, 32, 0, 1, 1, 0, 0xa0, 45, // configuration
    9, 4, 0, 0, 2, 0xff, 0xff, 0xff, 2, // interface
    7, 5, 0x81, 2, 64, 0, 0, // to the host
    7, 5, 0x02, 2, 64, 0, 0, // to the device
];
const LANGUAGES: [u8; 4] = [4, 3, 0x09, 0x04];

/// The adapter.
pub struct Ft232r {
    serial_number: String,
    latency: Duration,
    last_packet: Instant,
    byte_time: Duration,
    to_drive: Wire,
    to_host: Wire,
    /// Received from the drive, not yet requested.
    received: VecDeque<u8>,
    transfers: VecDeque<(u32, usize)>,
    completed: Vec<Completion>,
}

/// Bytes on their way, with the time at which each arrives.
#[derive(Default)]
struct Wire(VecDeque<(Instant, u8)>);

impl Wire {
    fn send(&mut self, bytes: &[u8], byte_time: Duration, now: Instant) {
        let mut arrival = self.0.back().map_or(now, |(at, _)| now.max(*at));
        for &byte in bytes {
            arrival += byte_time;
            self.0.push_back((arrival, byte));
        }
    }

    fn arrived(&mut self, now: Instant) -> impl Iterator<Item = u8> {
        let count = self.0.iter().take_while(|(at, _)| *at <= now).count();
        self.0.drain(..count).map(|(_, byte)| byte)
    }

    fn next(&self) -> Option<Instant> {
        self.0.front().map(|(at, _)| *at)
    }
}

impl Ft232r {
    /// An adapter that was just plugged in.
    #[must_use]
    pub fn new(serial_number: &str, now: Instant) -> Self {
        Self {
            serial_number: serial_number.to_owned(),
            latency: DEFAULT_LATENCY,
            last_packet: now,
            byte_time: Duration::ZERO,
            to_drive: Wire::default(),
            to_host: Wire::default(),
            received: VecDeque::new(),
            transfers: VecDeque::new(),
            completed: Vec::new(),
        }
    }

    /// Requests a transfer.
    pub fn submit(&mut self, urb: &Urb, now: Instant) {
        let number = urb.number;
        match (urb.endpoint, urb.direction) {
            (0, _) => {
                let completion = match (self.control(urb), urb.direction) {
                    (None, _) => Completion::stalled(number),
                    (Some(_), UsbDirection::Out) => Completion::taken(number, urb.data.len()),
                    (Some(mut data), UsbDirection::In) => {
                        data.truncate(urb.length);
                        Completion::given(number, data)
                    }
                };
                self.completed.push(completion);
            }
            (1, UsbDirection::In) => self.transfers.push_back((number, urb.length)),
            (2, UsbDirection::Out) => {
                self.to_drive.send(&urb.data, self.byte_time, now);
                self.completed.push(Completion::taken(number, urb.data.len()));
            }
            _ => self.completed.push(Completion::stalled(number)),
        }
    }

    /// Takes a transfer back; returns whether it was still pending.
    pub fn unlink(&mut self, number: u32) -> bool {
        let before = self.transfers.len();
        self.transfers.retain(|transfer| transfer.0 != number);
        self.transfers.len() != before
    }

    /// The bytes that have reached the drive.
    pub fn take_for_drive(&mut self, now: Instant) -> Vec<u8> {
        self.to_drive.arrived(now).collect()
    }

    /// Puts bytes of the drive on the wire.
    pub fn send_to_host(&mut self, bytes: &[u8], now: Instant) {
        self.to_host.send(bytes, self.byte_time, now);
    }

    /// The transfers that have ended: a packet is sent when it is full, or when the latency timer expires.
    pub fn completed(&mut self, now: Instant) -> Vec<Completion> {
        self.received.extend(self.to_host.arrived(now));
        while let Some(&(number, length)) = self.transfers.front() {
            if self.received.len() < PAYLOAD && now < self.last_packet + self.latency {
                break;
            }
            let mut data = Vec::new();
            loop {
                let count = self.received.len().min(PAYLOAD);
                data.extend(STATUS);
                data.extend(self.received.drain(..count));
                // A short packet ends the transfer.
                if count < PAYLOAD || data.len() + PACKET > length {
                    break;
                }
            }
            self.last_packet = now;
            self.transfers.pop_front();
            self.completed.push(Completion::given(number, data));
        }
        std::mem::take(&mut self.completed)
    }

    /// When a byte arrives or the timer expires.
    #[must_use]
    pub fn next_event(&self) -> Option<Instant> {
        let timer = (!self.transfers.is_empty()).then(|| self.last_packet + self.latency);
        [timer, self.to_drive.next(), self.to_host.next()].into_iter().flatten().min()
    }

    /// Answers a request; `None` rejects it.
    fn control(&mut self, urb: &Urb) -> Option<Vec<u8>> {
        let [kind, request, value_low, value_high, index_low, ..] = urb.setup;
        let value = u16::from_le_bytes([value_low, value_high]);
        match (kind, request) {
            // Standard requests: descriptors, status, configuration.
            (0x80, 6) => self.descriptor(value_high, value_low),
            (0x80..=0x82, 0) => Some(vec![0, 0]),
            (0x80, 8) => Some(vec![1]),
            (0x00..=0x02, _) => Some(Vec::new()),
            // FTDI's: reset, modem lines, flow control, data bits, event and error characters.
            (0x40, 0 | 1 | 2 | 4 | 6 | 7) => Some(Vec::new()),
            (0x40, 3) => {
                self.byte_time = Duration::from_secs(10) / baud(value, index_low);
                Some(Vec::new())
            }
            (0xc0, 5) => Some(STATUS.to_vec()),
            (0x40, 9) => {
                self.latency = Duration::from_millis(value.into());
                Some(Vec::new())
            }
            (0xc0, 10) => Some(vec![self.latency.as_millis() as u8]),
            // Memory of the chip, erased.
            (0xc0, 0x90) => Some(vec![0xff, 0xff]),
            _ => None,
        }
    }

    fn descriptor(&self, kind: u8, index: u8) -> Option<Vec<u8>> {
        match (kind, index) {
            (1, _) => Some(DEVICE.to_vec()),
            (2, _) => Some(CONFIGURATION.to_vec()),
            (3, 0) => Some(LANGUAGES.to_vec()),
            (3, 1) => Some(text("FTDI")),
            (3, 2) => Some(text("FT232R USB UART")),
            (3, 3) => Some(text(&self.serial_number)),
            _ => None,
        }
    }
}

fn text(text: &str) -> Vec<u8> {
    let mut units: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let mut descriptor = vec![2 + units.len() as u8, 3];
    descriptor.append(&mut units);
    descriptor
}

/// Bits per second: 3 MHz by a divisor in eighths, whose fraction is coded in three bits (AN232B-05).
fn baud(value: u16, index: u8) -> u32 {
    const EIGHTHS: [u32; 8] = [0, 4, 2, 1, 3, 5, 6, 7];
    let fraction = EIGHTHS[usize::from(value >> 14 | u16::from(index & 1) << 2)];
    match u32::from(value & 0x3fff) * 8 + fraction {
        0 => 3_000_000,
        1..=8 => 2_000_000,
        eighths => 24_000_000 / eighths,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn urb(number: u32, endpoint: u8, direction: UsbDirection, setup: [u8; 8], data: &[u8]) -> Urb {
        Urb { number, endpoint, direction, length: 512, setup, data: data.to_vec() }
    }

    #[test]
    fn received_bytes_wait_for_the_latency_timer() {
        let start = Instant::now();
        let mut chip = Ft232r::new("A", start);
        chip.submit(&urb(1, 1, UsbDirection::In, [0; 8], &[]), start);
        chip.send_to_host(b"torque", start);
        assert_eq!(chip.completed(start + Duration::from_millis(15)), []);
        assert_eq!(chip.next_event(), Some(start + DEFAULT_LATENCY));
        let [Completion { data, .. }] = &chip.completed(start + DEFAULT_LATENCY)[..] else { panic!("one") };
        assert_eq!(data, b"\x01\x60torque");
    }

    #[test]
    fn a_full_packet_does_not_wait() {
        let start = Instant::now();
        let mut chip = Ft232r::new("A", start);
        chip.submit(&urb(1, 1, UsbDirection::In, [0; 8], &[]), start);
        chip.send_to_host(&[7; PAYLOAD], start);
        assert_eq!(chip.completed(start)[0].data.len(), PACKET + STATUS.len());
    }

    #[test]
    fn the_divisor_of_921600_gives_923076_baud() {
        assert_eq!(baud(0x8003, 0), 24_000_000 / 26);
        assert_eq!(baud(0, 0), 3_000_000);
        assert_eq!(baud(1, 0), 2_000_000);
        assert_eq!(baud(0x001a, 0), 115_384);
    }

    #[test]
    fn a_byte_takes_its_time_on_the_wire() {
        let start = Instant::now();
        let mut chip = Ft232r::new("A", start);
        // The divisor 26 of 115,200 bit/s.
        chip.submit(&urb(1, 0, UsbDirection::Out, [0x40, 3, 0x1a, 0, 0, 0, 0, 0], &[]), start);
        chip.submit(&urb(2, 2, UsbDirection::Out, [0; 8], b"ab"), start);
        assert_eq!(chip.take_for_drive(start + Duration::from_micros(86)), b"");
        assert_eq!(chip.take_for_drive(start + Duration::from_micros(87)), b"a");
        assert_eq!(chip.take_for_drive(start + Duration::from_micros(174)), b"b");
    }
}
