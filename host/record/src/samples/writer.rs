//! Writes `run.mcap` during a run.

use std::path::Path;

use lashloop_bench::atomic_file::{GrowingFile, WriteError};
use lashloop_bench::run::{Event, Step};
use lashloop_plant::metrics::SignalTable;

use super::columns::{
    DRIVE_TOPIC, FAULT_TOPIC, LOG_TOPIC, STEP_TOPIC, drive_fields, step_fields, step_values,
};
use super::container::{Attachment, Channel, MessageHead, Schema, Writer};
use super::events::{self, FAULT_SCHEMA, LOG_SCHEMA};
use super::layout::{Field, encode, schema};
use super::packing::{MESSAGE_ENCODING, PROFILE, SCHEMA_ENCODING};
use super::step_times::StepTimes;
use crate::file_names::SAMPLES_FILE;

/// Writes the samples of a run.
pub struct SampleWriter {
    file: Writer,
    step: Topic,
    /// `None` for a drive without signals.
    drive: Option<Topic>,
    faults: u16,
    logs: u16,
    events: u64,
    times: StepTimes,
    steps: u64,
    flush_rows: u64,
    /// Time of the sample of the last telemetry, for what repeats it.
    telemetry_time_s: Option<f64>,
    message: Vec<u8>,
}

struct Topic {
    channel: u16,
    fields: Vec<Field>,
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
        let mut channel = |topic, name, schema: &str| add_channel(&mut file, topic, name, schema, times);
        let fields = step_fields(signals);
        let step = Topic { channel: channel(STEP_TOPIC, "Step", &schema(&fields)), fields };
        let fields = drive_fields(signals);
        // A message of ROS 2 has at least one field.
        let drive = (!fields.is_empty())
            .then(|| Topic { channel: channel(DRIVE_TOPIC, "Drive", &schema(&fields)), fields });
        let faults = channel(FAULT_TOPIC, "Fault", FAULT_SCHEMA);
        let logs = channel(LOG_TOPIC, "Log", LOG_SCHEMA);
        file.flush()?;
        Ok(Self {
            file,
            step,
            drive,
            faults,
            logs,
            events: 0,
            times,
            steps: first_step,
            flush_rows,
            telemetry_time_s: None,
            message: Vec::new(),
        })
    }

    /// Appends a step. It gets to the file with the chunk begun.
    ///
    /// # Errors
    /// The chunk can't be written. Those before are kept.
    pub fn push(&mut self, step: &Step) -> Result<(), WriteError> {
        let (number, now_ns) = (self.steps, self.times.at(self.steps));
        self.steps += 1;
        encode(&self.step.fields, step_values(number, step), &mut self.message);
        self.write(self.step.channel, 0, now_ns, now_ns);
        if step.drive.time_s != self.telemetry_time_s
            && let Some(Topic { channel, fields }) = &self.drive
        {
            self.telemetry_time_s = step.drive.time_s;
            let time_ns = step.drive.time_s.map_or(0, |time_s| (time_s * 1e9).round() as u64);
            encode(fields, step.drive.values.iter().copied(), &mut self.message);
            self.write(*channel, number, self.times.start_ns + time_ns, now_ns);
        }
        if self.steps.is_multiple_of(self.flush_rows) { self.file.flush() } else { Ok(()) }
    }

    /// Appends an event of a step. It gets to the file as a step does.
    pub fn push_event(&mut self, step: u32, event: &Event) {
        events::encode(event, &mut self.message);
        let (channel, step) = match event {
            Event::Fault(edge) => (self.faults, edge.step),
            Event::Log(_) => (self.logs, step),
        };
        let (time_ns, now_ns) = (self.times.at(step.into()), self.times.at(self.steps));
        self.write(channel, self.events, time_ns, now_ns);
        self.events += 1;
    }

    fn write(&mut self, channel: u16, number: u64, log_time: u64, publish_time: u64) {
        let head = MessageHead { channel, sequence: number as u32, log_time, publish_time };
        self.file.message(&head, &self.message);
    }

    /// Writes the summary as an attachment, and the end of the file.
    ///
    /// # Errors
    /// They can't be written.
    pub fn finish(mut self, (name, summary): (&str, &str)) -> Result<(), WriteError> {
        self.file.attach(&attachment(name, summary, self.times.at(self.steps)))?;
        self.file.finish()
    }
}

/// Adds the channel of a topic with its schema; returns its number.
pub(super) fn add_channel(file: &mut Writer, topic: &str, name: &str, schema: &str, times: StepTimes) -> u16 {
    let (name, metadata) = (format!("lashloop_msgs/msg/{name}"), times.metadata());
    let schema = Schema { name: &name, encoding: SCHEMA_ENCODING, data: schema.as_bytes() };
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
