//! Writes `run.mcap` during a run.

use std::path::Path;

use lashloop_bench::atomic_file::{GrowingFile, WriteError};
use lashloop_bench::run::{Event, Step};
use lashloop_plant::metrics::SignalTable;

use super::columns::{
    DRIVE_TOPIC, FAULT_TOPIC, LOG_TOPIC, PERIOD_US, STEP_TOPIC, drive_fields, step_fields, step_values,
};
use super::container::{MessageHead, Writer};
use super::events::{self, FAULT_SCHEMA, LOG_SCHEMA};
use super::layout::{Field, MESSAGE_ENCODING, SCHEMA_ENCODING, encode, schema};
use crate::file_names::SAMPLES_FILE;

/// Writes the samples of a run.
pub struct SampleWriter {
    file: Writer,
    step: Topic,
    drive: Topic,
    faults: u16,
    logs: u16,
    events: u64,
    period_ns: u64,
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
        period_us: u32,
        first_step: u64,
        flush_rows: u64,
        attached: &[(&str, String)],
    ) -> Result<Self, WriteError> {
        let growing = GrowingFile::create(&folder.join(SAMPLES_FILE), ".samples-", b"")?;
        let mut file = Writer::new(growing, MESSAGE_ENCODING);
        for (name, text) in attached {
            file.attach(name, media_type(name), text)?;
        }
        let period = period_us.to_string();
        let mut topic = |topic: &str, name: &str, fields: Vec<Field>| {
            let schema = file.add_schema(name, SCHEMA_ENCODING, &schema(&fields));
            let channel = file.add_channel(schema, topic, MESSAGE_ENCODING, &[(PERIOD_US, &period)]);
            Topic { channel, fields }
        };
        let step = topic(STEP_TOPIC, "lashloop/Step", step_fields(signals));
        let drive = topic(DRIVE_TOPIC, "lashloop/Drive", drive_fields(signals));
        let mut channel = |topic: &str, name: &str, schema: &str| {
            let schema = file.add_schema(name, SCHEMA_ENCODING, schema);
            file.add_channel(schema, topic, MESSAGE_ENCODING, &[])
        };
        let faults = channel(FAULT_TOPIC, "lashloop/Fault", FAULT_SCHEMA);
        let logs = channel(LOG_TOPIC, "lashloop/Log", LOG_SCHEMA);
        file.flush()?;
        Ok(Self {
            file,
            step,
            drive,
            faults,
            logs,
            events: 0,
            period_ns: 1000 * u64::from(period_us),
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
        let (number, now_ns) = (self.steps, self.steps * self.period_ns);
        self.steps += 1;
        self.message.clear();
        encode(&self.step.fields, step_values(number, step), &mut self.message);
        self.write(self.step.channel, 0, now_ns, now_ns);
        if step.drive.time_s != self.telemetry_time_s && !self.drive.fields.is_empty() {
            self.telemetry_time_s = step.drive.time_s;
            let time_ns = step.drive.time_s.map_or(0, |time_s| (time_s * 1e9).round() as u64);
            self.message.clear();
            encode(&self.drive.fields, step.drive.values.iter().copied(), &mut self.message);
            self.write(self.drive.channel, number, time_ns, now_ns);
        }
        if self.steps.is_multiple_of(self.flush_rows) { self.file.flush() } else { Ok(()) }
    }

    /// Appends an event of a step. It gets to the file as a step does.
    pub fn push_event(&mut self, step: u32, event: &Event) {
        self.message.clear();
        events::encode(event, &mut self.message);
        let (channel, step) = match event {
            Event::Fault(edge) => (self.faults, edge.step),
            Event::Log(_) => (self.logs, step),
        };
        let (time_ns, now_ns) = (u64::from(step) * self.period_ns, self.steps * self.period_ns);
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
        self.file.attach(name, media_type(name), summary)?;
        self.file.finish()
    }
}

fn media_type(name: &str) -> &'static str {
    match Path::new(name).extension().and_then(std::ffi::OsStr::to_str) {
        Some("json") => "application/json",
        Some("toml") => "application/toml",
        Some("csv") => "text/csv",
        _ => "text/plain",
    }
}
