//! Reads `run.mcap`, also of an interrupted run.

use std::collections::HashMap;
use std::io::{self, BufReader, Cursor, Read, Seek, SeekFrom};
use std::path::Path;

use lashloop_bench::regular_file::RegularFile;
use lashloop_plant::Signal;

use super::columns::{
    DRIVE_TOPIC, FAULT_TOPIC, LOG_TOPIC, NO_TIME_NS, SAMPLED, STEP_TOPIC, in_ns, timing_columns,
};
use super::container::{self, Channel, ContainerError, End, Entry, MAGIC, MessageHead};
use super::events::{self, RecordedEdge, RecordedText};
use super::layout::{Field, decode, fields};
use super::packing::Packing;
use super::step_times::StepTimes;
use crate::columns::Columns;
use crate::trace::{TELEMETRY_TIME, TIME, sent_columns};

/// The samples of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Samples {
    /// Every column of the trace, one row per step.
    pub trace: Columns,
    /// Timing of each step.
    pub timing: Columns,
    /// Begins and ends of injected faults.
    pub faults: Vec<RecordedEdge>,
    /// Texts of the drive.
    pub logs: Vec<RecordedText>,
    /// Whether the file ends within a chunk, which is omitted.
    pub is_torn: bool,
}

/// Why `run.mcap` is unusable.
#[derive(Debug, thiserror::Error)]
pub enum SamplesError {
    /// The file can't be read.
    #[error("can't be read: {0}")]
    Read(#[from] io::Error),
    /// Not MCAP, or damaged.
    #[error("can't be read as MCAP: {0}")]
    Mcap(#[from] ContainerError),
    /// A channel of another program.
    #[error("topic {topic} has no schema of Lashloop")]
    Schema {
        /// The topic.
        topic: String,
    },
    /// Messages in the encoding of another program, or of a newer version.
    #[error("topic {topic} is encoded as {encoding}; this version of lashloop reads cdr and ros1")]
    Encoding {
        /// The topic.
        topic: String,
        /// The encoding.
        encoding: String,
    },
    /// More samples than a file of this size can have.
    #[error(
        "the samples need more than {limit} bytes of memory, far more than those of a run in a file of this size"
    )]
    Memory {
        /// The limit.
        limit: usize,
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
        let RegularFile { file, length } = RegularFile::open(path)?;
        Self::of(BufReader::new(file), length)
    }

    /// As [`read`](Self::read), of the bytes of a file.
    ///
    /// # Errors
    /// Another program has written them.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, SamplesError> {
        Self::of(Cursor::new(bytes), bytes.len() as u64)
    }

    fn of(file: impl Read + Seek, length: u64) -> Result<Self, SamplesError> {
        let mut memory = Memory::of(length);
        let (mut steps, mut drive) = (Messages::of(STEP_TOPIC), Messages::of(DRIVE_TOPIC));
        let (mut faults, mut logs) = (Vec::new(), Vec::new());
        let (mut schemas, mut topics) = (HashMap::new(), HashMap::new());
        let is_torn = up_to_the_end(file, length, |entry| {
            match entry {
                Entry::Schema { id, schema } => {
                    memory.take(schema.data.len())?;
                    schemas.insert(id, schema.data.to_owned());
                }
                // From the channels, not from the messages: a run may be cut before the first telemetry.
                Entry::Channel { id, channel } => {
                    let schema = schemas.get(&channel.schema);
                    memory.take(channel.topic.len())?;
                    for messages in [&mut steps, &mut drive] {
                        messages.begin(id, &channel, schema)?;
                    }
                    topics.insert(id, (channel.topic.to_owned(), Packing::named(channel.encoding)));
                }
                Entry::Message { head, data } => {
                    let at = steps.times.step_at(head.log_time);
                    let topic = topics.get(&head.channel).map(|(topic, packing)| (&**topic, *packing));
                    // What is kept of a message: numbers, or a text.
                    memory.take(match topic {
                        Some((STEP_TOPIC, _)) => steps.row_bytes(0),
                        Some((DRIVE_TOPIC, _)) => drive.row_bytes(0),
                        Some(_) => data.len(),
                        None => 0,
                    })?;
                    match topic {
                        Some((STEP_TOPIC, _)) => steps.take(at, &head, data)?,
                        Some((DRIVE_TOPIC, _)) => drive.take(head.sequence.into(), &head, data)?,
                        Some((FAULT_TOPIC, Some(it))) => faults.extend(events::edge(at, it, data)),
                        Some((LOG_TOPIC, Some(it))) => logs.extend(events::text(at, it, data)),
                        _ => {}
                    }
                }
                Entry::Header { .. } | Entry::Attachment(_) => {}
            }
            Ok(())
        })?;
        // Each step has the telemetry in force too, and columns that an early version has not written.
        memory.take(steps.numbers.len().saturating_mul(drive.row_bytes(16)))?;
        let (trace, timing) = assembled(steps, &drive);
        Ok(Self { trace, timing, faults, logs, is_torn })
    }
}

/// Passes the entries of a file to `take`, up to its last whole chunk; returns whether a part of another follows.
///
/// # Errors
/// Another program has written the file, it is damaged, or `take` fails.
pub(super) fn up_to_the_end(
    mut file: impl Read + Seek,
    length: u64,
    take: impl FnMut(Entry<'_>) -> Result<(), SamplesError>,
) -> Result<bool, SamplesError> {
    // A killed run has left no end, and perhaps a part of its last chunk, or anything on a full disk.
    let has_end = ends_with_magic(&mut file, length)?;
    match container::read(file, length, take) {
        Ok(End::Data | End::Record) => Ok(false),
        Ok(End::Torn) if has_end => Err(ContainerError::End.into()),
        Ok(End::Torn) => Ok(true),
        Err(SamplesError::Mcap(error)) if !has_end && !matches!(error, ContainerError::Magic) => Ok(true),
        Err(error) => Err(error),
    }
}

/// Whether the file has its end; the next byte read is its first.
fn ends_with_magic(file: &mut (impl Read + Seek), length: u64) -> io::Result<bool> {
    let mut end = [0; MAGIC.len()];
    let Some(at) = length.checked_sub(MAGIC.len() as u64) else { return Ok(false) };
    file.seek(SeekFrom::Start(at))?;
    file.read_exact(&mut end)?;
    file.rewind()?;
    Ok(end == MAGIC)
}

/// What the samples of a file may take in memory. Runs keep about twice the size of their file; a file of a few megabytes
/// can unpack to thousands of times its size.
struct Memory {
    left: usize,
    limit: usize,
}

impl Memory {
    const FLOOR: usize = 384 << 20;
    const PER_BYTE: usize = 16;

    fn of(file: u64) -> Self {
        let file = usize::try_from(file).unwrap_or(usize::MAX);
        let limit = file.saturating_mul(Self::PER_BYTE).saturating_add(Self::FLOOR);
        Self { left: limit, limit }
    }

    /// Takes what is about to be kept.
    fn take(&mut self, bytes: usize) -> Result<(), SamplesError> {
        // And the books on it.
        let left = bytes.checked_add(64).and_then(|bytes| self.left.checked_sub(bytes));
        self.left = left.ok_or(SamplesError::Memory { limit: self.limit })?;
        Ok(())
    }
}

/// The columns of the trace, and those of the timing.
fn assembled(mut steps: Messages, drive: &Messages) -> (Columns, Columns) {
    let period_us = f64::from(steps.times.period_us);
    let (period_s, period_ns) = (period_us / 1e6, 1000.0 * period_us);
    let numbers = steps.numbers.iter().map(|number| *number as f64);
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
    (trace, Columns::from_parts(timing))
}

fn microseconds(ns: f64) -> f64 {
    if ns == NO_TIME_NS { f64::NAN } else { ns / 1e3 }
}

/// The messages of a topic, field by field.
struct Messages {
    topic: &'static str,
    /// `None` before the channel of the topic.
    channel: Option<u16>,
    fields: Vec<Field>,
    values: Vec<Vec<f64>>,
    /// Steps of the messages.
    numbers: Vec<u64>,
    /// Their times since the start of the run.
    times_ns: Vec<u64>,
    times: StepTimes,
    packing: Packing,
    message: Vec<f64>,
}

impl Messages {
    fn of(topic: &'static str) -> Self {
        let (fields, values, message) = (Vec::new(), Vec::new(), Vec::new());
        let (numbers, times_ns, times) = (Vec::new(), Vec::new(), StepTimes { start_ns: 0, period_us: 0 });
        let packing = Packing::Cdr;
        Self { topic, channel: None, fields, values, numbers, times_ns, times, packing, message }
    }

    /// Bytes of a message in memory, with this many columns more.
    fn row_bytes(&self, more: usize) -> usize {
        (self.fields.len() + more) * size_of::<f64>()
    }

    /// Takes the message of a step.
    fn take(&mut self, number: u64, head: &MessageHead, data: &[u8]) -> Result<(), SamplesError> {
        self.message.clear();
        if !decode(&self.fields, self.packing, data, &mut self.message) {
            return Err(SamplesError::Message { topic: self.topic.to_owned() });
        }
        for (values, value) in self.values.iter_mut().zip(&self.message) {
            values.push(*value);
        }
        self.numbers.push(number);
        self.times_ns.push(self.times.since_start(head.log_time));
        Ok(())
    }

    /// Takes the fields of the channel, if it is that of the topic.
    fn begin(
        &mut self,
        id: u16,
        channel: &Channel<'_>,
        schema: Option<&Vec<u8>>,
    ) -> Result<(), SamplesError> {
        if channel.topic != self.topic || self.channel.is_some() {
            return Ok(());
        }
        let topic = self.topic.to_owned();
        let Some(packing) = Packing::named(channel.encoding) else {
            return Err(SamplesError::Encoding { topic, encoding: channel.encoding.to_owned() });
        };
        let fields = schema.and_then(|schema| fields(std::str::from_utf8(schema).ok()?));
        let (Some(fields), Some(times)) = (fields, StepTimes::of(&channel.metadata)) else {
            return Err(SamplesError::Schema { topic });
        };
        (self.channel, self.times, self.packing) = (Some(id), times, packing);
        self.values = vec![Vec::new(); fields.len()];
        self.fields = fields;
        Ok(())
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
