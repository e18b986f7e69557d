//! The control steps of a capture as columns: counts, torque and telemetry from the frames alone.

use crate::capture::reader::{self, ReadError};
use lashloop_plant::Signal;
use lashloop_plant::metrics::DRIVE_PREFIX;
use lashloop_protocol::enums::ParameterValue;
use lashloop_protocol::field_value::FieldValue;
use lashloop_protocol::parameter_names::PERIOD_US;
use lashloop_protocol::sequence::{LONGEST_GAP, nearest_step};
use lashloop_record::columns::Columns;

use super::entry::DecodedMessage;
use super::reader::PacketReader;

/// The steps of a capture.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// `time_s` first, or `step` if the capture has no control period. NaN where a step has no value.
    pub columns: Columns,
    /// Why the capture ends early, if it does.
    pub torn: Option<String>,
}

/// Reads the steps of a capture of the whole file `bytes`. `None` without a step. A second `Start` continues the steps.
#[must_use]
pub fn series(bytes: &[u8]) -> Option<Series> {
    let (mut reader, mut collector, mut torn) = (PacketReader::default(), Collector::default(), None);
    for packet in reader::packets(bytes) {
        match packet {
            Ok(packet) => reader.push(&packet, |entry| {
                if let Ok(message) = &entry.message {
                    collector.take(message);
                }
            }),
            Err(error @ (ReadError::Truncated { .. } | ReadError::Malformed { .. } | ReadError::Io(_))) => {
                torn = Some(error.to_string());
            }
        }
    }
    Some(Series { columns: collector.columns()?, torn })
}

#[derive(Default)]
struct Collector {
    /// Steps before the latest `Start`.
    origin: u32,
    /// The latest step since then.
    step: u32,
    steps: u32,
    /// Index of the parameter `period_us`, and its value.
    period_index: Option<u32>,
    period_us: Option<u32>,
    signals: Vec<Signal>,
    /// Values by signal, then by step, up to the last one that has a value.
    values: Vec<Vec<f64>>,
}

impl Collector {
    fn take(&mut self, message: &DecodedMessage) {
        let value =
            |name: &str| message.fields().find(|(field, _)| field.name == name).map(|(_, value)| value);
        let integer = |name: &str| match value(name) {
            Some(FieldValue::Unsigned(value) | FieldValue::Parameter(ParameterValue::U32(value))) => {
                Some(value)
            }
            _ => None,
        };
        match message.layout.name {
            "ParameterDescription" if matches!(value("name"), Some(FieldValue::Text(PERIOD_US))) => {
                self.period_index = integer("index");
                self.period_us = integer("default");
            }
            "ParameterReport" if self.period_index.is_some() && integer("index") == self.period_index => {
                self.period_us = integer("value").or(self.period_us);
            }
            "Start" => (self.origin, self.step) = (self.steps, 0),
            "EncoderSample" | "BenchSample" => {
                let Some(step) = integer("sequence").and_then(|it| nearest_step(it as u16, self.step)) else {
                    return;
                };
                // A drive rejects a sample beyond the gap as a stray frame.
                if step > self.step + u32::from(LONGEST_GAP) {
                    return;
                }
                self.step = step;
                self.steps = self.steps.max(self.origin + step + 1);
                self.numbers(message, step);
            }
            "TorqueAnswer" | "Telemetry" => {
                let Some(step) = integer("sequence").and_then(|it| nearest_step(it as u16, self.step)) else {
                    return;
                };
                // An answer to no sample of this capture has no row.
                if self.origin + step < self.steps {
                    self.numbers(message, step);
                    for (label, value) in message.signals() {
                        let name = format!("{DRIVE_PREFIX}{}", label.name);
                        self.put(step, &name, &label.unit, f64::from(value));
                    }
                }
            }
            _ => {}
        }
    }

    /// Keeps the fields of a message that have a unit.
    fn numbers(&mut self, message: &DecodedMessage, step: u32) {
        for (field, value) in message.fields() {
            let number = match value {
                FieldValue::Signed(value) => f64::from(value),
                FieldValue::Real(value) => f64::from(value),
                FieldValue::Unsigned(value) if field.name.ends_with("_tenths_us") => f64::from(value) / 10.0,
                _ => continue,
            };
            let (name, unit) = match field.name.strip_suffix("_tenths_us") {
                Some(name) => (format!("{name}_us"), "us"),
                None => (field.name.to_owned(), field.unit().unwrap_or_default()),
            };
            self.put(step, &name, unit, number);
        }
    }

    fn put(&mut self, step: u32, name: &str, unit: &str, value: f64) {
        let known = self.signals.iter().position(|signal| signal.name == name);
        let signal = known.unwrap_or_else(|| {
            self.signals.push(Signal { name: name.to_owned().into(), unit: unit.to_owned().into() });
            self.values.push(Vec::new());
            self.signals.len() - 1
        });
        let (row, column) = ((self.origin + step) as usize, &mut self.values[signal]);
        if column.len() <= row {
            column.resize(row + 1, f64::NAN);
        }
        column[row] = value;
    }

    fn columns(self) -> Option<Columns> {
        let Self { steps, period_us, mut signals, values, .. } = self;
        if steps == 0 {
            return None;
        }
        let (axis, scale) = match period_us {
            Some(period_us) => (Signal::new("time_s", "s"), f64::from(period_us) * 1e-6),
            None => (Signal::new("step", ""), 1.0),
        };
        signals.insert(0, axis);
        let mut columns = Columns::new(signals);
        for step in 0..steps {
            let row = values.iter().map(|column| column.get(step as usize).copied().unwrap_or(f64::NAN));
            columns.push(std::iter::once(f64::from(step) * scale).chain(row));
        }
        Some(columns)
    }
}
