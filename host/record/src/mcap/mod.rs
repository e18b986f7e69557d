//! [MCAP](https://mcap.dev/spec): a file of records, each of which is a kind, a length and as many bytes.
//!
//! | module | does |
//! |---|---|
//! | `writer` | whole chunks of messages, compressed by Zstandard; attachments; the summary at the end |
//! | `reader` | the records of a file and of its chunks, up to the end or to where it was cut off |

mod reader;
mod writer;

pub use reader::McapError;
pub(crate) use reader::{Channel, Record, records};
pub(crate) use writer::McapWriter;

/// First and last bytes of a file.
pub(crate) const MAGIC: [u8; 8] = *b"\x89MCAP0\r\n";

/// Compression of the chunks, as the format names it.
const ZSTANDARD: &str = "zstd";

/// The sum of a chunk or of an attachment.
const CRC: crc::Crc<u32, crc::Table<16>> = crc::Crc::<u32, crc::Table<16>>::new(&crc::CRC_32_ISO_HDLC);

/// Kinds of records.
mod kind {
    pub(super) const HEADER: u8 = 0x01;
    pub(super) const FOOTER: u8 = 0x02;
    pub(super) const SCHEMA: u8 = 0x03;
    pub(super) const CHANNEL: u8 = 0x04;
    pub(super) const MESSAGE: u8 = 0x05;
    pub(super) const CHUNK: u8 = 0x06;
    pub(super) const ATTACHMENT: u8 = 0x09;
    pub(super) const ATTACHMENT_INDEX: u8 = 0x0a;
    pub(super) const STATISTICS: u8 = 0x0b;
    pub(super) const DATA_END: u8 = 0x0f;
}

/// What precedes the data of a message. Times are in ns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct MessageHeader {
    pub(crate) channel_id: u16,
    pub(crate) sequence: u32,
    pub(crate) log_time: u64,
    pub(crate) publish_time: u64,
}

#[cfg(test)]
mod tests;
