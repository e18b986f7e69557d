//! The container of MCAP (<https://mcap.dev/spec>), as far as a record needs it: schemas, channels, messages in chunks compressed
//! by LZ4 with an index of each, attachments, and a summary. What other programs add is passed over.

mod read;
mod write;

use std::io;

use crc::{CRC_32_ISO_HDLC, Crc, Table};

pub(super) use read::{End, Entry, read};
pub(super) use write::Writer;

/// At the start and the end of a file.
pub(super) const MAGIC: [u8; 8] = *b"\x89MCAP0\r\n";
const CRC32: Crc<u32, Table<16>> = Crc::<u32, Table<16>>::new(&CRC_32_ISO_HDLC);
const LZ4: &str = "lz4";
/// Bytes of a record before its content: opcode and length.
const HEAD: usize = 9;

mod opcode {
    /// No record has it.
    pub(super) const NONE: u8 = 0;
    pub(super) const HEADER: u8 = 0x01;
    pub(super) const FOOTER: u8 = 0x02;
    pub(super) const SCHEMA: u8 = 0x03;
    pub(super) const CHANNEL: u8 = 0x04;
    pub(super) const MESSAGE: u8 = 0x05;
    pub(super) const CHUNK: u8 = 0x06;
    pub(super) const MESSAGE_INDEX: u8 = 0x07;
    pub(super) const CHUNK_INDEX: u8 = 0x08;
    pub(super) const ATTACHMENT: u8 = 0x09;
    pub(super) const ATTACHMENT_INDEX: u8 = 0x0a;
    pub(super) const STATISTICS: u8 = 0x0b;
    pub(super) const SUMMARY_OFFSET: u8 = 0x0e;
    pub(super) const DATA_END: u8 = 0x0f;
}

/// Why a file is not read.
#[derive(Debug, thiserror::Error)]
pub enum ContainerError {
    /// The file does not begin as MCAP does.
    #[error("it doesn't begin with the magic of MCAP")]
    Magic,
    /// A record is shorter than its fields.
    #[error("a record of kind {opcode:#04x} is too short")]
    Short {
        /// The kind.
        opcode: u8,
    },
    /// A chunk is compressed in another manner.
    #[error("a chunk is compressed by {name:?}; lashloop reads lz4 and uncompressed chunks")]
    Compression {
        /// The name in the chunk.
        name: String,
    },
    /// A chunk can't be uncompressed.
    #[error("a chunk is damaged: {0}")]
    Lz4(io::Error),
    /// A chunk holds more or less than it says.
    #[error("a chunk is damaged: its length is wrong")]
    Length,
    /// A chunk or another record is larger than any that lashloop writes.
    #[error("a chunk or record claims {bytes} bytes; the limit is {limit}")]
    Large {
        /// Its size, as it says.
        bytes: u64,
        /// The limit.
        limit: u64,
    },
    /// The file has an end, and a record before it that reaches beyond.
    #[error("it is damaged: a record reaches beyond the end of the file")]
    End,
    /// The checksum of a chunk is another one.
    #[error("a chunk is damaged: its checksum is wrong")]
    Checksum,
}

/// A schema: a name, and a text in an encoding.
#[derive(Debug, Clone, Copy)]
pub(super) struct Schema<'a> {
    pub(super) name: &'a str,
    pub(super) encoding: &'a str,
    pub(super) data: &'a [u8],
}

/// A channel: a topic whose messages have an encoding and a schema.
#[derive(Debug, Clone)]
pub(super) struct Channel<'a> {
    pub(super) schema: u16,
    pub(super) topic: &'a str,
    pub(super) encoding: &'a str,
    pub(super) metadata: Vec<(&'a str, &'a str)>,
}

/// A file within the file.
#[derive(Debug, Clone, Copy)]
pub(super) struct Attachment<'a> {
    /// In ns.
    pub(super) log_time: u64,
    pub(super) name: &'a str,
    pub(super) media_type: &'a str,
    pub(super) data: &'a [u8],
}

/// A message without its data.
#[derive(Debug, Clone, Copy)]
pub(super) struct MessageHead {
    pub(super) channel: u16,
    pub(super) sequence: u32,
    /// In ns.
    pub(super) log_time: u64,
    /// In ns.
    pub(super) publish_time: u64,
}

/// Opcode and content of the first record, and what is behind it; `None` if it isn't whole.
fn split_record(bytes: &[u8]) -> Option<(u8, &[u8], &[u8])> {
    let ([opcode, length @ ..], rest) = bytes.split_first_chunk::<HEAD>()?;
    let length = usize::try_from(u64::from_le_bytes(*length)).ok()?;
    let (content, behind) = rest.split_at_checked(length)?;
    Some((*opcode, content, behind))
}
