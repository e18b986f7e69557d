//! Writes `run.mcap` during a run.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};

use lashloop_bench::atomic_file::{GrowingFile, WriteError};
use lashloop_bench::run::{Event, Step};
use lashloop_plant::metrics::SignalTable;
use mcap::records::MessageHeader;
use mcap::write::NoSeek;
use mcap::{Attachment, Compression, McapError, WriteOptions, Writer};

use super::columns::{
    DRIVE_TOPIC, FAULT_TOPIC, LOG_TOPIC, PERIOD_US, STEP_TOPIC, drive_fields, step_fields, step_values,
};
use super::events::{self, FAULT_SCHEMA, LOG_SCHEMA};
use super::layout::{Field, MESSAGE_ENCODING, SCHEMA_ENCODING, encode, schema};
use super::sink::Sink;
use crate::file_names::SAMPLES_FILE;

/// Writes the samples of a run.
pub struct SampleWriter {
    path: PathBuf,
    file: Writer<NoSeek<Sink>>,
    step: Topic,
    drive: Topic,
    faults: u16,
    logs: u16,
    events: u64,
    period_ns: u64,
    steps: u64,
    /// Time of the sample of the last telemetry, for what repeats it.
    telemetry_time_s: Option<f64>,
    message: Vec<u8>,
}

struct Topic {
    channel: u16,
    fields: Vec<Field>,
}

impl SampleWriter {
    /// Creates `run.mcap` in `folder`, with these files attached. `first_step` is the number of the first step to come.
    ///
    /// # Errors
    /// The file can't be created or written.
    pub fn create(
        folder: &Path,
        signals: &SignalTable,
        period_us: u32,
        first_step: u64,
        attached: &[(&str, String)],
    ) -> Result<Self, WriteError> {
        let path = folder.join(SAMPLES_FILE);
        let growing = GrowingFile::create(&path, ".samples-", b"")?;
        Self::begin(path.clone(), growing, signals, period_us, first_step, attached)
            .map_err(|error| written(&path, error))
    }

    fn begin(
        path: PathBuf,
        growing: GrowingFile,
        signals: &SignalTable,
        period_us: u32,
        first_step: u64,
        attached: &[(&str, String)],
    ) -> Result<Self, McapError> {
        let mut file = open(growing)?;
        for (name, text) in attached {
            attach(&mut file, name, text)?;
        }
        let metadata = BTreeMap::from([(PERIOD_US.to_owned(), period_us.to_string())]);
        let mut topic = |topic: &str, name: &str, fields: Vec<Field>| -> Result<Topic, McapError> {
            let schema_id = file.add_schema(name, SCHEMA_ENCODING, schema(&fields).as_bytes())?;
            let channel = file.add_channel(schema_id, topic, MESSAGE_ENCODING, &metadata)?;
            Ok(Topic { channel, fields })
        };
        let step = topic(STEP_TOPIC, "lashloop/Step", step_fields(signals))?;
        let drive = topic(DRIVE_TOPIC, "lashloop/Drive", drive_fields(signals))?;
        let mut channel = |topic: &str, name: &str, schema: &str| {
            let schema_id = file.add_schema(name, SCHEMA_ENCODING, schema.as_bytes())?;
            file.add_channel(schema_id, topic, MESSAGE_ENCODING, &BTreeMap::new())
        };
        let faults = channel(FAULT_TOPIC, "lashloop/Fault", FAULT_SCHEMA)?;
        let logs = channel(LOG_TOPIC, "lashloop/Log", LOG_SCHEMA)?;
        file.flush()?;
        Ok(Self {
            path,
            file,
            step,
            drive,
            faults,
            logs,
            events: 0,
            period_ns: 1000 * u64::from(period_us),
            steps: first_step,
            telemetry_time_s: None,
            message: Vec::new(),
        })
    }

    /// Appends a step. It gets to the file with the next [`flush`](Self::flush).
    ///
    /// # Errors
    /// The step can't be written.
    pub fn push(&mut self, step: &Step) -> Result<(), WriteError> {
        let (number, now_ns) = (self.steps, self.steps * self.period_ns);
        self.steps += 1;
        self.message.clear();
        encode(&self.step.fields, step_values(number, step), &mut self.message);
        let mut result = self.write(self.step.channel, 0, now_ns, now_ns);
        if step.drive.time_s != self.telemetry_time_s && !self.drive.fields.is_empty() {
            self.telemetry_time_s = step.drive.time_s;
            let time_ns = step.drive.time_s.map_or(0, |time_s| (time_s * 1e9).round() as u64);
            self.message.clear();
            encode(&self.drive.fields, step.drive.values.iter().copied(), &mut self.message);
            result = result.and_then(|()| self.write(self.drive.channel, number, time_ns, now_ns));
        }
        result.map_err(|error| written(&self.path, error))
    }

    /// Appends an event of a step. It gets to the file as a step does.
    ///
    /// # Errors
    /// The event can't be written.
    pub fn push_event(&mut self, step: u32, event: &Event) -> Result<(), WriteError> {
        self.message.clear();
        events::encode(event, &mut self.message);
        let (channel, step) = match event {
            Event::Fault(edge) => (self.faults, edge.step),
            Event::Log(_) => (self.logs, step),
        };
        let (time_ns, now_ns) = (u64::from(step) * self.period_ns, self.steps * self.period_ns);
        let result = self.write(channel, self.events, time_ns, now_ns);
        self.events += 1;
        result.map_err(|error| written(&self.path, error))
    }

    fn write(
        &mut self,
        channel_id: u16,
        number: u64,
        log_time: u64,
        publish_time: u64,
    ) -> Result<(), McapError> {
        let header = MessageHeader { channel_id, sequence: number as u32, log_time, publish_time };
        self.file.write_to_known_channel(&header, &self.message)
    }

    /// Writes the chunk begun.
    ///
    /// # Errors
    /// The chunk can't be written. Those before are kept.
    pub fn flush(&mut self) -> Result<(), WriteError> {
        self.file.flush().map_err(|error| written(&self.path, error))
    }

    /// Writes the summary as an attachment, and the end of the file.
    ///
    /// # Errors
    /// They can't be written.
    pub fn finish(mut self, (name, summary): (&str, &str)) -> Result<(), WriteError> {
        let mut end = || {
            self.file.flush()?;
            attach(&mut self.file, name, summary)?;
            self.file.finish().map(|_| ())
        };
        end().map_err(|error| written(&self.path, error))
    }
}

fn attach(file: &mut Writer<NoSeek<Sink>>, name: &str, text: &str) -> Result<(), McapError> {
    let extension = Path::new(name).extension().and_then(std::ffi::OsStr::to_str);
    let media_type = match extension {
        Some("json") => "application/json",
        Some("toml") => "application/toml",
        Some("csv") => "text/csv",
        _ => "text/plain",
    };
    file.attach(&Attachment {
        log_time: 0,
        create_time: 0,
        name: name.to_owned(),
        media_type: media_type.to_owned(),
        data: Cow::Borrowed(text.as_bytes()),
    })
}

/// A writer whose chunks get to the file whole, by a flush.
pub(super) fn open(file: GrowingFile) -> Result<Writer<NoSeek<Sink>>, McapError> {
    WriteOptions::new()
        .profile("ros1")
        .library(concat!("lashloop ", env!("CARGO_PKG_VERSION")))
        .disable_seeking(true)
        .chunk_size(None)
        .compression(Some(Compression::Lz4))
        .emit_message_indexes(false)
        .emit_chunk_indexes(false)
        .create(NoSeek::new(Sink::new(file)))
}

pub(super) fn written(path: &Path, error: McapError) -> WriteError {
    let source = match error {
        McapError::Io(source) => source,
        other => io::Error::other(other),
    };
    WriteError { path: path.to_owned(), action: "written", source }
}
