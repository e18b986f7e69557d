//! Reads `run.mcap`, also of an interrupted run.

use std::fs;
use std::io;
use std::path::Path;

use lashloop_plant::Signal;
use mcap::read::Options;
use mcap::{Channel, McapError, Message, MessageStream};

use super::columns::{DRIVE_TOPIC, NO_TIME_NS, PERIOD_US, SAMPLED, STEP_TOPIC, in_ns, timing_columns};
use super::layout::{Field, decode, fields};
use crate::columns::Columns;
use crate::trace::{TELEMETRY_TIME, TIME, sent_columns};

/// The samples of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Samples {
    /// Every column of the trace, one row per step.
    pub trace: Columns,
    /// Timing of each step.
    pub timing: Columns,
    /// Whether the file has no end, or ends within a chunk that was omitted.
    pub is_torn: bool,
}

/// Why `run.mcap` is unusable.
#[derive(Debug, thiserror::Error)]
pub enum SamplesError {
    /// The file can't be read.
    #[error("can't be read: {0}")]
    Read(#[from] io::Error),
    /// Not MCAP.
    #[error("is no MCAP file: {0}")]
    Mcap(#[from] McapError),
    /// A channel of another program.
    #[error("topic {topic} has no schema of Lashloop")]
    Schema {
        /// The topic.
        topic: String,
    },
    /// A message that is shorter than its schema.
    #[error("a message of topic {topic} is shorter than its schema")]
    Message {
        /// The topic.
        topic: String,
    },
}

impl Samples {
    /// Reads a file up to its last whole chunk.
    ///
    /// # Errors
    /// The file can't be read, or another program has written it.
    pub fn read(path: &Path) -> Result<Self, SamplesError> {
        let bytes = fs::read(path)?;
        // A killed run has left no end, and perhaps a part of its last chunk.
        let is_torn = !bytes.ends_with(mcap::MAGIC);
        let (mut steps, mut drive) = (Messages::default(), Messages::default());
        for message in MessageStream::new_with_options(&bytes, Options::IgnoreEndMagic.into())? {
            match message {
                Ok(message) if message.channel.topic == STEP_TOPIC => steps.take(&message)?,
                Ok(message) if message.channel.topic == DRIVE_TOPIC => drive.take(&message)?,
                Ok(_) => {}
                Err(_) if is_torn => break,
                Err(error) => return Err(error.into()),
            }
        }
        Ok(Self::assembled(steps, &drive, is_torn))
    }

    fn assembled(mut steps: Messages, drive: &Messages, is_torn: bool) -> Self {
        let (period_s, period_ns) = (f64::from(steps.period_us) / 1e6, 1000.0 * f64::from(steps.period_us));
        let numbers = steps.numbers.iter().map(|number| f64::from(*number));
        let time_s = numbers.clone().map(|number| number * period_s).collect();
        let number = numbers.collect();
        // The telemetry in force in each step.
        let mut latest = None;
        let mut arrived = (0..).zip(&drive.numbers).peekable();
        let telemetry: Vec<Option<usize>> = (steps.numbers.iter())
            .map(|step| {
                while let Some((row, _)) = arrived.next_if(|(_, number)| *number <= step) {
                    latest = Some(row);
                }
                latest
            })
            .collect();
        let repeated = |values: &[f64]| {
            telemetry.iter().map(|row| row.map_or(f64::NAN, |row| values[row])).collect::<Vec<_>>()
        };
        let sent_at = |ns: &u64| (*ns as f64 / period_ns).round() * period_s;
        let telemetry_time_s: Vec<_> = drive.times_ns.iter().map(sent_at).collect();
        let drive_columns = drive.fields.iter().zip(&drive.values);
        let drive_columns = drive_columns.map(|(field, values)| (field.column.clone(), repeated(values)));

        let sampled = steps.remove(SAMPLED);
        let mut sent = Vec::new();
        for column in sent_columns() {
            let mut values = steps.remove(&column.name);
            for (value, _) in values.iter_mut().zip(&sampled).filter(|(_, sampled)| **sampled == 0.0) {
                *value = f64::NAN;
            }
            sent.push((column, values));
        }
        let mut timing = vec![(Signal::new("step", ""), number)];
        for (name, unit) in timing_columns() {
            let values = match unit {
                "us" => steps.remove(&in_ns(name)).into_iter().map(microseconds).collect(),
                _ => steps.remove(name),
            };
            timing.push((Signal::new(name, unit), values));
        }
        let truth = steps.fields.into_iter().map(|field| field.column).zip(steps.values);
        let trace = [(Signal::new(TIME, "s"), time_s)].into_iter().chain(truth).chain(drive_columns);
        let last = (Signal::new(TELEMETRY_TIME, "s"), repeated(&telemetry_time_s));
        let trace = Columns::from_parts(trace.chain([last]).chain(sent));
        Self { trace, timing: Columns::from_parts(timing), is_torn }
    }
}

fn microseconds(ns: f64) -> f64 {
    if ns == NO_TIME_NS { f64::NAN } else { ns / 1e3 }
}

/// The messages of a topic, field by field.
#[derive(Default)]
struct Messages {
    fields: Vec<Field>,
    values: Vec<Vec<f64>>,
    numbers: Vec<u32>,
    times_ns: Vec<u64>,
    period_us: u32,
    message: Vec<f64>,
}

impl Messages {
    fn take(&mut self, message: &Message<'_>) -> Result<(), SamplesError> {
        let topic = || message.channel.topic.clone();
        if self.numbers.is_empty() {
            self.begin(&message.channel).ok_or_else(|| SamplesError::Schema { topic: topic() })?;
        }
        self.message.clear();
        if !decode(&self.fields, &message.data, &mut self.message) {
            return Err(SamplesError::Message { topic: topic() });
        }
        for (values, value) in self.values.iter_mut().zip(&self.message) {
            values.push(*value);
        }
        self.numbers.push(message.sequence);
        self.times_ns.push(message.log_time);
        Ok(())
    }

    fn begin(&mut self, channel: &Channel<'_>) -> Option<()> {
        let schema = channel.schema.as_ref()?;
        self.fields = fields(std::str::from_utf8(&schema.data).ok()?)?;
        self.values = vec![Vec::new(); self.fields.len()];
        self.period_us = channel.metadata.get(PERIOD_US)?.parse().ok()?;
        Some(())
    }

    /// Takes a field out. Without messages it has no values.
    fn remove(&mut self, name: &str) -> Vec<f64> {
        match self.fields.iter().position(|field| field.column.name == name) {
            Some(at) => {
                self.fields.remove(at);
                self.values.remove(at)
            }
            None => vec![f64::NAN; self.numbers.len()],
        }
    }
}
