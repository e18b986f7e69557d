//! A copy of `run.mcap` that has its index, of an interrupted run too.

use std::collections::HashMap;
use std::io::{self, BufReader};
use std::path::Path;

use lashloop_bench::atomic_file::{GrowingFile, WriteError};
use lashloop_bench::regular_file::RegularFile;

use super::container::{Channel, Entry, MessageHead, Writer};
use super::reader::up_to_the_end;

/// Messages of a chunk.
const CHUNK: usize = 1000;

/// Copies samples up to their last whole chunk, with their attachments, and writes index and end behind them.
///
/// # Errors
/// The samples are unusable, or the copy can't be written.
pub fn copy_with_index(samples: &Path, path: &Path) -> Result<(), WriteError> {
    let error = |source| WriteError { path: path.to_owned(), action: "written", source };
    let RegularFile { file, length } = RegularFile::open(samples).map_err(error)?;
    let mut new = Some(GrowingFile::create(path, ".samples-", b"")?);
    let (mut copy, mut written) = (None, Ok(()));
    let read = up_to_the_end(BufReader::new(file), length, |entry| {
        if let Some(file) = new.take() {
            let profile = if let Entry::Header { profile } = entry { profile } else { "" };
            copy = Some(Copy::new(Writer::new(file, profile)));
        }
        if let (Some(copy), Ok(())) = (&mut copy, &written) {
            written = Copy::take(copy, &entry);
        }
        Ok(())
    });
    read.map_err(|unusable| error(io::Error::other(unusable)))?;
    written?;
    copy.map_or(Ok(()), |copy| copy.file.finish())
}

struct Copy {
    file: Writer,
    /// Numbers in the copy, by those in the samples.
    schemas: HashMap<u16, u16>,
    channels: HashMap<u16, u16>,
    messages: usize,
}

impl Copy {
    fn new(file: Writer) -> Self {
        Self { file, schemas: HashMap::new(), channels: HashMap::new(), messages: 0 }
    }

    fn take(&mut self, entry: &Entry<'_>) -> Result<(), WriteError> {
        match entry {
            Entry::Header { .. } => {}
            Entry::Schema { id, schema } => {
                self.schemas.insert(*id, self.file.add_schema(schema));
            }
            Entry::Channel { id, channel } => {
                let schema = self.schemas.get(&channel.schema).copied().unwrap_or_default();
                let channel = Channel { schema, ..channel.clone() };
                self.channels.insert(*id, self.file.add_channel(&channel));
            }
            Entry::Attachment(attachment) => self.file.attach(attachment)?,
            Entry::Message { head, data } => {
                let Some(channel) = self.channels.get(&head.channel).copied() else { return Ok(()) };
                self.file.message(&MessageHead { channel, ..*head }, data);
                self.messages += 1;
                if self.messages.is_multiple_of(CHUNK) {
                    self.file.flush()?;
                }
            }
        }
        Ok(())
    }
}
