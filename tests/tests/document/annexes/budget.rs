//! What a line carries: bits under the CRC, time of telemetry, and the most signals at a speed.

use std::fmt::Write;

use lashloop_protocol::crc;
use lashloop_protocol::limits::MAX_TELEMETRY_VALUES;
use lashloop_protocol::message::{EncoderSample, Telemetry, TorqueAnswer};
use lashloop_protocol::wire::Payload;

/// Bits of a byte on a UART: start, 8 data bits, stop.
const BITS_PER_BYTE: f64 = 10.0;
/// Speed of the line unless another one is set, in bit/s.
const BITS_PER_S: f64 = 921_600.0;
/// Numbers of signals of the table.
const SIGNALS: [usize; 7] = [1, 2, 4, 6, 8, 10, 13];
/// Speeds of the table, in bit/s.
const SPEEDS: [u32; 5] = [115_200, 230_400, 460_800, 921_600, 1_000_000];

/// The part of the annex with this name.
pub fn part(name: &str) -> Option<String> {
    match name {
        "bits" => Some(bits()),
        "telemetry" => Some(telemetry()),
        "speeds" => Some(speeds()),
        "mean" => Some(mean()),
        _ => None,
    }
}

fn bits() -> String {
    let row = |(name, body_len): (&str, usize)| format!("| `{name}` | {} |", (body_len + crc::LEN) * 8);
    let rows = [EncoderSample::LAYOUT, TorqueAnswer::LAYOUT].map(|it| row((it.name, it.body_len)));
    format!("| body and CRC of | bits |\n|---|---|\n{}", rows.join("\n"))
}

fn torque_len() -> usize {
    TorqueAnswer::LAYOUT.frame_len()
}

fn telemetry_len(signals: usize) -> usize {
    Telemetry::LAYOUT.frame_len_of(signals).expect("a number of values that telemetry has")
}

fn telemetry() -> String {
    let us = |bytes: usize| (bytes as f64 * BITS_PER_BYTE / BITS_PER_S * 1e6).round() as u32;
    let mut rows =
        "| n | frame bytes | telemetry, us | torque and telemetry, us |\n|---|---|---|---|".to_owned();
    for signals in SIGNALS {
        let bytes = telemetry_len(signals);
        let _ = write!(rows, "\n| {signals} | {bytes} | {} | {} |", us(bytes), us(torque_len() + bytes));
    }
    rows
}

/// Bytes on the line in a period of 1 ms.
fn bytes_per_period(bits_per_s: f64) -> f64 {
    bits_per_s / BITS_PER_BYTE * 1e-3
}

fn speeds() -> String {
    let mut rows = "| bit/s | bytes per period | largest n |\n|---|---|---|".to_owned();
    for bits_per_s in SPEEDS {
        let bytes = bytes_per_period(bits_per_s.into());
        let fits = |signals: &usize| (torque_len() + telemetry_len(*signals)) as f64 <= bytes;
        let largest = (1..=MAX_TELEMETRY_VALUES).filter(fits).max().unwrap_or(0);
        let largest = if torque_len() as f64 > bytes {
            format!("no loop: a torque alone is {} bytes", torque_len())
        } else {
            largest.to_string()
        };
        let _ = write!(rows, "\n| {bits_per_s} | {bytes:.1} | {largest} |");
    }
    rows
}

fn mean() -> String {
    let mean = torque_len() as f64 + telemetry_len(6) as f64 / 10.0;
    let percent = 100.0 * mean / bytes_per_period(BITS_PER_S);
    format!("{mean:.1} bytes or {percent:.0} % of 921,600 bit/s.")
}
