//! Writes a file, record by record.

use std::io::Write as _;

use lashloop_bench::atomic_file::{GrowingFile, WriteError};
use lz4_flex::frame::{BlockMode, BlockSize, FrameEncoder, FrameInfo};

use super::{Attachment, CRC32, Channel, HEAD, LZ4, MAGIC, MessageHead, Schema, opcode};

/// The content of a record, field by field.
#[derive(Default)]
struct Content(Vec<u8>);

impl Content {
    fn u16(mut self, value: u16) -> Self {
        self.0.extend_from_slice(&value.to_le_bytes());
        self
    }

    fn u32(mut self, value: u32) -> Self {
        self.0.extend_from_slice(&value.to_le_bytes());
        self
    }

    fn u64(mut self, value: u64) -> Self {
        self.0.extend_from_slice(&value.to_le_bytes());
        self
    }

    /// Bytes behind their length in four bytes.
    fn bytes(self, bytes: &[u8]) -> Self {
        let mut content = self.u32(bytes.len() as u32);
        content.0.extend_from_slice(bytes);
        content
    }

    fn text(self, text: &str) -> Self {
        self.bytes(text.as_bytes())
    }
}

fn push_record(opcode: u8, content: &[u8], bytes: &mut Vec<u8>) {
    bytes.push(opcode);
    bytes.extend_from_slice(&(content.len() as u64).to_le_bytes());
    bytes.extend_from_slice(content);
}

/// Writes a file. Each [`flush`](Self::flush) is one write, so that an interrupted run leaves whole records.
#[derive(Debug)]
pub(in crate::samples) struct Writer {
    file: GrowingFile,
    /// Records to write, the chunk apart.
    pending: Vec<u8>,
    /// Bytes before them.
    written: u64,
    /// The messages of the chunk begun.
    chunk: Vec<u8>,
    /// First and last time of its messages.
    chunk_ns: Option<(u64, u64)>,
    /// Time and place of its messages, channel by channel.
    index: Vec<Vec<u8>>,
    /// The parts of the summary.
    schemas: Vec<u8>,
    channels: Vec<u8>,
    attachments: Vec<u8>,
    /// About 130 bytes for each chunk; nothing else in memory grows with the run.
    chunks: Vec<u8>,
    schema_count: u16,
    /// Messages of each channel, which have the numbers from 1.
    messages: Vec<u64>,
    attachment_count: u32,
    chunk_count: u32,
    /// First and last time of all messages.
    all_ns: Option<(u64, u64)>,
    has_ended: bool,
}

impl Drop for Writer {
    /// The file of a run that ended with an error has all its messages and an end.
    fn drop(&mut self) {
        if !self.has_ended {
            let _ = self.end();
        }
    }
}

impl Writer {
    /// Begins a file. Nothing is written before the first flush.
    pub(in crate::samples) fn new(file: GrowingFile, profile: &str) -> Self {
        let mut pending = MAGIC.to_vec();
        let library = concat!("lashloop ", env!("CARGO_PKG_VERSION"));
        push_record(opcode::HEADER, &Content::default().text(profile).text(library).0, &mut pending);
        Self {
            file,
            pending,
            written: 0,
            chunk: Vec::new(),
            chunk_ns: None,
            index: Vec::new(),
            schemas: Vec::new(),
            channels: Vec::new(),
            attachments: Vec::new(),
            chunks: Vec::new(),
            schema_count: 0,
            messages: Vec::new(),
            attachment_count: 0,
            chunk_count: 0,
            all_ns: None,
            has_ended: false,
        }
    }

    /// Adds a schema; returns its number.
    pub(in crate::samples) fn add_schema(&mut self, schema: &Schema<'_>) -> u16 {
        let Schema { name, encoding, data } = schema;
        self.schema_count += 1;
        let content = Content::default().u16(self.schema_count).text(name).text(encoding).bytes(data);
        push_record(opcode::SCHEMA, &content.0, &mut self.pending);
        push_record(opcode::SCHEMA, &content.0, &mut self.schemas);
        self.schema_count
    }

    /// Adds a channel of a schema; returns its number.
    pub(in crate::samples) fn add_channel(&mut self, channel: &Channel<'_>) -> u16 {
        let Channel { schema, topic, encoding, metadata } = channel;
        self.messages.push(0);
        self.index.push(Vec::new());
        let number = self.messages.len() as u16;
        let pairs = metadata.iter().fold(Content::default(), |it, (name, value)| it.text(name).text(value));
        let content = Content::default().u16(number).u16(*schema).text(topic).text(encoding).bytes(&pairs.0);
        push_record(opcode::CHANNEL, &content.0, &mut self.pending);
        push_record(opcode::CHANNEL, &content.0, &mut self.channels);
        number
    }

    /// Bytes of the chunk begun.
    pub(in crate::samples) fn begun(&self) -> usize {
        self.chunk.len()
    }

    /// Adds a message of a channel to the chunk.
    pub(in crate::samples) fn message(&mut self, head: &MessageHead, data: &[u8]) {
        let MessageHead { channel, sequence, log_time, publish_time } = *head;
        let length = (2 + 4 + 8 + 8 + data.len()) as u64;
        let place = [log_time.to_le_bytes(), (self.chunk.len() as u64).to_le_bytes()];
        self.index[usize::from(channel) - 1].extend_from_slice(place.as_flattened());
        self.chunk.push(opcode::MESSAGE);
        let head = Content(std::mem::take(&mut self.chunk)).u64(length).u16(channel).u32(sequence);
        self.chunk = head.u64(log_time).u64(publish_time).0;
        self.chunk.extend_from_slice(data);
        self.messages[usize::from(channel) - 1] += 1;
        for range in [&mut self.chunk_ns, &mut self.all_ns] {
            let (first, last) = range.unwrap_or((log_time, log_time));
            *range = Some((first.min(log_time), last.max(log_time)));
        }
    }

    /// Adds a file, outside of the chunk.
    ///
    /// # Errors
    /// The chunk begun can't be written.
    pub(in crate::samples) fn attach(&mut self, attachment: &Attachment<'_>) -> Result<(), WriteError> {
        self.flush()?;
        let Attachment { log_time, name, media_type, data } = *attachment;
        let length = data.len() as u64;
        let head = Content::default().u64(log_time).u64(0).text(name).text(media_type).u64(length);
        let Content(mut content) = head;
        content.extend_from_slice(data);
        content.extend_from_slice(&CRC32.checksum(&content).to_le_bytes());
        let index = Content::default().u64(self.written + self.pending.len() as u64);
        let index = index.u64((HEAD + content.len()) as u64).u64(log_time).u64(0).u64(length);
        push_record(opcode::ATTACHMENT_INDEX, &index.text(name).text(media_type).0, &mut self.attachments);
        self.attachment_count += 1;
        push_record(opcode::ATTACHMENT, &content, &mut self.pending);
        Ok(())
    }

    /// Writes the chunk begun and what precedes it.
    ///
    /// # Errors
    /// The file can't be written. What was written before is kept.
    pub(in crate::samples) fn flush(&mut self) -> Result<(), WriteError> {
        if let Some((first_ns, last_ns)) = self.chunk_ns.take() {
            let info = FrameInfo::new().block_mode(BlockMode::Linked).block_size(BlockSize::Max256KB);
            let mut encoder = FrameEncoder::with_frame_info(info, Vec::new());
            encoder.write_all(&self.chunk).expect("writing to memory does not fail");
            let compressed = encoder.finish().expect("writing to memory does not fail");
            let head = Content::default().u64(first_ns).u64(last_ns).u64(self.chunk.len() as u64);
            let head = head.u32(CRC32.checksum(&self.chunk)).text(LZ4).u64(compressed.len() as u64);
            let Content(mut content) = head;
            content.extend_from_slice(&compressed);
            let start = self.written + self.pending.len() as u64;
            push_record(opcode::CHUNK, &content, &mut self.pending);
            let index_start = self.written + self.pending.len() as u64;
            let offsets = self.push_message_indexes();
            let index_end = self.written + self.pending.len() as u64;
            let index = Content::default().u64(first_ns).u64(last_ns).u64(start).u64(index_start - start);
            let index = index.bytes(&offsets).u64(index_end - index_start).text(LZ4);
            let index = index.u64(compressed.len() as u64).u64(self.chunk.len() as u64);
            push_record(opcode::CHUNK_INDEX, &index.0, &mut self.chunks);
            self.chunk.clear();
            self.chunk_count += 1;
        }
        self.write()
    }

    /// The indexes of the chunk's messages, each behind the one of the channel before; returns channels and places.
    fn push_message_indexes(&mut self) -> Vec<u8> {
        let mut offsets = Content::default();
        for (channel, places) in (1..).zip(&mut self.index).filter(|(_, places)| !places.is_empty()) {
            offsets = offsets.u16(channel).u64(self.written + self.pending.len() as u64);
            let index = Content::default().u16(channel).bytes(places);
            push_record(opcode::MESSAGE_INDEX, &index.0, &mut self.pending);
            places.clear();
        }
        offsets.0
    }

    fn write(&mut self) -> Result<(), WriteError> {
        let result = self.file.append(&self.pending);
        self.written += self.pending.len() as u64;
        self.pending.clear();
        result
    }

    /// Writes the summary and the end.
    ///
    /// # Errors
    /// They can't be written.
    pub(in crate::samples) fn finish(mut self) -> Result<(), WriteError> {
        self.end()
    }

    fn end(&mut self) -> Result<(), WriteError> {
        self.has_ended = true;
        self.flush()?;
        push_record(opcode::DATA_END, &Content::default().u32(0).0, &mut self.pending);
        self.write()?;
        let summary_start = self.written;
        let mut offsets = Vec::new();
        let statistics = self.statistics();
        let groups = [
            (opcode::SCHEMA, &self.schemas),
            (opcode::CHANNEL, &self.channels),
            (opcode::STATISTICS, &statistics),
            (opcode::CHUNK_INDEX, &self.chunks),
            (opcode::ATTACHMENT_INDEX, &self.attachments),
        ];
        for (opcode, records) in groups.into_iter().filter(|(_, records)| !records.is_empty()) {
            let Content(mut offset) = Content(vec![opcode]).u64(summary_start + self.pending.len() as u64);
            offset.extend_from_slice(&(records.len() as u64).to_le_bytes());
            push_record(opcode::SUMMARY_OFFSET, &offset, &mut offsets);
            self.pending.extend_from_slice(records);
        }
        let offsets_start = summary_start + self.pending.len() as u64;
        self.pending.extend_from_slice(&offsets);
        // The checksum covers the summary and the footer up to itself.
        let footer = Content::default().u64(summary_start).u64(offsets_start);
        self.pending.push(opcode::FOOTER);
        self.pending.extend_from_slice(&(footer.0.len() as u64 + 4).to_le_bytes());
        self.pending.extend_from_slice(&footer.0);
        let crc = CRC32.checksum(&self.pending);
        self.pending.extend_from_slice(&crc.to_le_bytes());
        self.pending.extend_from_slice(&MAGIC);
        self.write()
    }

    fn statistics(&self) -> Vec<u8> {
        let counts = (1..).zip(&self.messages);
        let counts = counts.fold(Content::default(), |it, (channel, count)| it.u16(channel).u64(*count));
        let (first_ns, last_ns) = self.all_ns.unwrap_or_default();
        let content = Content::default().u64(self.messages.iter().sum()).u16(self.schema_count);
        let content = content.u32(self.messages.len() as u32).u32(self.attachment_count).u32(0);
        let content = content.u32(self.chunk_count).u64(first_ns).u64(last_ns).bytes(&counts.0);
        let mut record = Vec::new();
        push_record(opcode::STATISTICS, &content.0, &mut record);
        record
    }
}
