//! Writes `run.mcap` during a run.

use std::path::Path;

use lashloop_bench::atomic_file::{GrowingFile, WriteError};
use lashloop_bench::run::{Event, Step};
use lashloop_plant::metrics::SignalTable;

use super::container::{Attachment, Channel, MessageHead, Schema, Writer};
use super::encoder::{Encoder, Place, Topic};
use super::packing::{MESSAGE_ENCODING, PROFILE, SCHEMA_ENCODING};
use super::step_times::StepTimes;
use crate::file_names::SAMPLES_FILE;

/// A chunk of this many bytes is written before its steps are complete: a reader unpacks a chunk as a whole.
const LONG_CHUNK: usize = 64 << 20;

/// Writes the samples of a run.
pub struct SampleWriter {
    file: Writer,
    encoder: Encoder,
    /// The channel of each topic.
    channels: Vec<u16>,
    flush_rows: u64,
}

impl SampleWriter {
    /// Creates `run.mcap` in `folder`, with these files attached. `first_step` is the number of the first step to come;
    /// every `flush_rows` steps are written at once.
    ///
    /// # Errors
    /// The file can't be created or written.
    pub fn create(
        folder: &Path,
        signals: &SignalTable,
        times: StepTimes,
        first_step: u64,
        flush_rows: u64,
        attached: &[(&str, String)],
    ) -> Result<Self, WriteError> {
        let growing = GrowingFile::create(&folder.join(SAMPLES_FILE), ".samples-", b"")?;
        let mut file = Writer::new(growing, PROFILE);
        for (name, text) in attached {
            file.attach(&attachment(name, text, times.start_ns))?;
        }
        let encoder = Encoder::new(signals, times, first_step);
        let topics = encoder.topics();
        let mut channel = |it: &Topic| add_channel(&mut file, it.name, &it.schema_name, &it.schema, times);
        let channels = topics.iter().map(&mut channel).collect();
        file.flush()?;
        Ok(Self { file, encoder, channels, flush_rows })
    }

    /// Appends a step. It gets to the file with the chunk begun.
    ///
    /// # Errors
    /// The chunk can't be written. Those before are kept.
    pub fn push(&mut self, step: &Step) -> Result<(), WriteError> {
        let Self { file, encoder, channels, .. } = self;
        encoder.step(step, |place, message| write(file, channels, place, message));
        let is_due = self.encoder.steps().is_multiple_of(self.flush_rows) || self.file.begun() > LONG_CHUNK;
        if is_due { self.file.flush() } else { Ok(()) }
    }

    /// Appends an event of a step. It gets to the file as a step does.
    pub fn push_event(&mut self, step: u32, event: &Event) {
        let Self { file, encoder, channels, .. } = self;
        encoder.event(step, event, |place, message| write(file, channels, place, message));
    }

    /// Writes the summary as an attachment, and the end of the file.
    ///
    /// # Errors
    /// They can't be written.
    pub fn finish(mut self, (name, summary): (&str, &str)) -> Result<(), WriteError> {
        let end_ns = self.encoder.times().at(self.encoder.steps());
        self.file.attach(&attachment(name, summary, end_ns))?;
        self.file.finish()
    }
}

fn write(file: &mut Writer, channels: &[u16], place: Place, message: &[u8]) {
    let Place { topic, sequence, log_time_ns, publish_time_ns } = place;
    let head = MessageHead {
        channel: channels[topic],
        sequence,
        log_time: log_time_ns,
        publish_time: publish_time_ns,
    };
    file.message(&head, message);
}

/// Adds the channel of a topic with its schema; returns its number.
pub(super) fn add_channel(
    file: &mut Writer,
    topic: &str,
    schema_name: &str,
    schema: &str,
    times: StepTimes,
) -> u16 {
    let metadata = times.metadata();
    let schema = Schema { name: schema_name, encoding: SCHEMA_ENCODING, data: schema.as_bytes() };
    let schema = file.add_schema(&schema);
    let metadata = metadata.iter().map(|(name, value)| (*name, &**value)).collect();
    file.add_channel(&Channel { schema, topic, encoding: MESSAGE_ENCODING, metadata })
}

fn attachment<'a>(name: &'a str, text: &'a str, log_time: u64) -> Attachment<'a> {
    Attachment { log_time, name, media_type: media_type(name), data: text.as_bytes() }
}

fn media_type(name: &str) -> &'static str {
    match Path::new(name).extension().and_then(std::ffi::OsStr::to_str) {
        Some("json") => "application/json",
        Some("toml") => "application/toml",
        Some("csv") => "text/csv",
        _ => "text/plain",
    }
}
