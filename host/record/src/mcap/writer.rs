//! Writes a file chunk by chunk.

use std::path::Path;

use lashloop_bench::atomic_file::{GrowingFile, WriteError};
use ruzstd::encoding::{CompressionLevel, compress_to_vec};

use super::{CRC, MAGIC, MessageHeader, ZSTANDARD, kind};

/// A file that grows by whole chunks.
pub(crate) struct McapWriter {
    file: GrowingFile,
    /// What gets to the file with the next flush, before the chunk.
    pending: Vec<u8>,
    /// Bytes before `pending`.
    place: u64,
    /// After a failure nothing more is written: an end without what precedes it would be wrong.
    has_failed: bool,
    /// Schemas, channels and messages of the chunk.
    chunk: Vec<u8>,
    times: Option<(u64, u64)>,
    /// Schemas and channels, as the summary repeats them.
    declared: Vec<u8>,
    schemas: u16,
    /// Messages of each channel, by its number.
    messages: Vec<u64>,
    attachments: Vec<u8>,
    attachment_count: u32,
    chunk_count: u32,
    all_times: Option<(u64, u64)>,
}

impl McapWriter {
    /// Creates the file, which appears with the first flush. `prefix` begins the name of the temporary file until then.
    ///
    /// # Errors
    /// The file can't be created.
    pub(crate) fn create(path: &Path, prefix: &str) -> Result<Self, WriteError> {
        let mut pending = MAGIC.to_vec();
        record(&mut pending, kind::HEADER, |it| {
            text(it, "ros1");
            text(it, concat!("lashloop ", env!("CARGO_PKG_VERSION")));
        });
        Ok(Self {
            file: GrowingFile::create(path, prefix, b"")?,
            pending,
            place: 0,
            has_failed: false,
            chunk: Vec::new(),
            times: None,
            declared: Vec::new(),
            schemas: 0,
            messages: Vec::new(),
            attachments: Vec::new(),
            attachment_count: 0,
            chunk_count: 0,
            all_times: None,
        })
    }

    /// Declares a channel with its schema. Returns its number.
    pub(crate) fn add_channel(
        &mut self,
        topic: &str,
        (schema_name, schema_encoding, schema): (&str, &str, &str),
        message_encoding: &str,
        metadata: &[(&str, String)],
    ) -> u16 {
        self.schemas += 1;
        let (schema_id, channel_id) = (self.schemas, self.messages.len() as u16);
        self.messages.push(0);
        for out in [&mut self.chunk, &mut self.declared] {
            record(out, kind::SCHEMA, |it| {
                it.extend(schema_id.to_le_bytes());
                text(it, schema_name);
                text(it, schema_encoding);
                text(it, schema);
            });
            record(out, kind::CHANNEL, |it| {
                it.extend(channel_id.to_le_bytes());
                it.extend(schema_id.to_le_bytes());
                text(it, topic);
                text(it, message_encoding);
                sized(it, |it| {
                    for (key, value) in metadata {
                        text(it, key);
                        text(it, value);
                    }
                });
            });
        }
        channel_id
    }

    /// Appends a message to the chunk.
    pub(crate) fn push(&mut self, header: &MessageHeader, data: &[u8]) {
        let MessageHeader { channel_id, sequence, log_time, publish_time } = *header;
        record(&mut self.chunk, kind::MESSAGE, |it| {
            it.extend(channel_id.to_le_bytes());
            it.extend(sequence.to_le_bytes());
            it.extend(log_time.to_le_bytes());
            it.extend(publish_time.to_le_bytes());
            it.extend(data);
        });
        self.messages[usize::from(channel_id)] += 1;
        let (first, last) = self.times.unwrap_or((log_time, log_time));
        self.times = Some((first.min(log_time), last.max(log_time)));
    }

    /// Attaches a text. It gets to the file before the chunk begun.
    pub(crate) fn attach(&mut self, name: &str, media_type: &str, data: &str) {
        let offset = self.place + self.pending.len() as u64;
        let mut content = [0; 16].to_vec();
        text(&mut content, name);
        text(&mut content, media_type);
        content.extend((data.len() as u64).to_le_bytes());
        content.extend(data.as_bytes());
        content.extend(CRC.checksum(&content).to_le_bytes());
        record(&mut self.pending, kind::ATTACHMENT, |it| it.extend(&content));
        let length = self.place + self.pending.len() as u64 - offset;
        record(&mut self.attachments, kind::ATTACHMENT_INDEX, |it| {
            for number in [offset, length, 0, 0, data.len() as u64] {
                it.extend(number.to_le_bytes());
            }
            text(it, name);
            text(it, media_type);
        });
        self.attachment_count += 1;
    }

    /// Writes the chunk begun.
    ///
    /// # Errors
    /// It can't be written. Those before are kept.
    pub(crate) fn flush(&mut self) -> Result<(), WriteError> {
        if !self.chunk.is_empty() {
            let compressed = compress_to_vec(&self.chunk[..], CompressionLevel::Fastest);
            let (first, last) = self.times.unwrap_or_default();
            record(&mut self.pending, kind::CHUNK, |it| {
                for number in [first, last, self.chunk.len() as u64] {
                    it.extend(number.to_le_bytes());
                }
                it.extend(CRC.checksum(&self.chunk).to_le_bytes());
                text(it, ZSTANDARD);
                it.extend((compressed.len() as u64).to_le_bytes());
                it.extend(&compressed);
            });
            self.chunk.clear();
            self.chunk_count += 1;
            if let Some((first, last)) = self.times.take() {
                let (earliest, latest) = self.all_times.unwrap_or((first, last));
                self.all_times = Some((earliest.min(first), latest.max(last)));
            }
        }
        self.append()
    }

    fn append(&mut self) -> Result<(), WriteError> {
        if !self.has_failed {
            let result = self.file.append(&self.pending);
            self.place += self.pending.len() as u64;
            self.has_failed = result.is_err();
            result?;
        }
        self.pending.clear();
        Ok(())
    }

    /// Writes the chunk begun and the end of the file.
    ///
    /// # Errors
    /// They can't be written.
    pub(crate) fn finish(mut self) -> Result<(), WriteError> {
        self.flush()?;
        record(&mut self.pending, kind::DATA_END, |it| it.extend([0; 4]));
        let summary = self.place + self.pending.len() as u64;
        self.pending.extend(&self.declared);
        record(&mut self.pending, kind::STATISTICS, |it| {
            it.extend(self.messages.iter().sum::<u64>().to_le_bytes());
            it.extend(self.schemas.to_le_bytes());
            it.extend((self.messages.len() as u32).to_le_bytes());
            it.extend(self.attachment_count.to_le_bytes());
            it.extend([0; 4]); // Records of metadata.
            it.extend(self.chunk_count.to_le_bytes());
            let (first, last) = self.all_times.unwrap_or_default();
            it.extend(first.to_le_bytes());
            it.extend(last.to_le_bytes());
            sized(it, |it| {
                for (channel, messages) in (0_u16..).zip(&self.messages) {
                    it.extend(channel.to_le_bytes());
                    it.extend(messages.to_le_bytes());
                }
            });
        });
        self.pending.extend(&self.attachments);
        record(&mut self.pending, kind::FOOTER, |it| {
            it.extend(summary.to_le_bytes());
            it.extend([0; 12]); // No index of the summary, and no sum of it.
        });
        self.pending.extend(MAGIC);
        self.append()
    }
}

/// Appends a record.
fn record(out: &mut Vec<u8>, kind: u8, content: impl FnOnce(&mut Vec<u8>)) {
    out.push(kind);
    let begin = out.len();
    out.extend([0; 8]);
    content(out);
    let length = (out.len() - begin - 8) as u64;
    out[begin..begin + 8].copy_from_slice(&length.to_le_bytes());
}

/// Appends what has its length in front.
fn sized(out: &mut Vec<u8>, content: impl FnOnce(&mut Vec<u8>)) {
    let begin = out.len();
    out.extend([0; 4]);
    content(out);
    let length = (out.len() - begin - 4) as u32;
    out[begin..begin + 4].copy_from_slice(&length.to_le_bytes());
}

fn text(out: &mut Vec<u8>, text: &str) {
    sized(out, |it| it.extend(text.as_bytes()));
}
