//! Reads the records of a file.

use std::collections::HashMap;
use std::io::{self, Read as _};

use ruzstd::decoding::StreamingDecoder;

use super::{CRC, MAGIC, MessageHeader, ZSTANDARD, kind};

/// Why a file is no MCAP that this program reads.
#[derive(Debug, thiserror::Error)]
pub enum McapError {
    /// The file begins otherwise.
    #[error("it doesn't begin as one")]
    Magic,
    /// A record is shorter than its fields, or a chunk has another sum.
    #[error("a record of kind {kind:#04x} is damaged")]
    Damaged {
        /// The kind.
        kind: u8,
    },
    /// Another program has compressed the file.
    #[error("a chunk is compressed by {0}, which is not supported")]
    Compression(String),
    /// A chunk can't be decompressed.
    #[error("a chunk can't be decompressed: {0}")]
    Decompression(#[from] io::Error),
}

/// A record, as far as a reader of samples needs it.
#[derive(Debug, PartialEq)]
pub(crate) enum Record<'a> {
    Schema {
        id: u16,
        text: &'a [u8],
    },
    Channel(Channel),
    Message(MessageHeader, &'a [u8]),
    /// What follows repeats schemas and channels.
    DataEnd,
}

/// A channel.
#[derive(Debug, PartialEq)]
pub(crate) struct Channel {
    pub(crate) id: u16,
    pub(crate) schema_id: u16,
    pub(crate) topic: String,
    pub(crate) metadata: HashMap<String, String>,
}

/// Passes on the records of a file, those of its chunks included, until `take` returns `false`. Returns whether the last record
/// is whole: a file that ends within a record was cut off, and its rest is omitted.
///
/// # Errors
/// The file is no MCAP, a record is damaged, or `take` fails.
pub(crate) fn records<E: From<McapError>>(
    file: &[u8],
    mut take: impl FnMut(Record<'_>) -> Result<bool, E>,
) -> Result<bool, E> {
    let mut rest = file.strip_prefix(&MAGIC).ok_or(McapError::Magic)?;
    while rest != MAGIC && !rest.is_empty() {
        let Some((kind, content)) = split_record(&mut rest) else { return Ok(false) };
        let is_wanted = if kind == kind::CHUNK {
            let chunk = decompressed(content)?;
            let mut rest = &chunk[..];
            let mut is_wanted = true;
            while is_wanted && !rest.is_empty() {
                let (kind, content) = split_record(&mut rest).ok_or(McapError::Damaged { kind })?;
                is_wanted = pass_on(kind, content, &mut take)?;
            }
            is_wanted
        } else {
            pass_on(kind, content, &mut take)?
        };
        if !is_wanted {
            break;
        }
    }
    Ok(true)
}

fn pass_on<E: From<McapError>>(
    kind: u8,
    content: &[u8],
    take: &mut impl FnMut(Record<'_>) -> Result<bool, E>,
) -> Result<bool, E> {
    let record = match kind {
        kind::SCHEMA => schema(content),
        kind::CHANNEL => channel(content),
        kind::MESSAGE => message(content),
        kind::DATA_END => Some(Record::DataEnd),
        _ => return Ok(true),
    };
    take(record.ok_or(McapError::Damaged { kind })?)
}

/// Kind and content of the first record.
fn split_record<'a>(bytes: &mut &'a [u8]) -> Option<(u8, &'a [u8])> {
    let mut rest = *bytes;
    let [kind] = array(&mut rest)?;
    let length = u64::from_le_bytes(array(&mut rest)?);
    let content = split(&mut rest, length)?;
    *bytes = rest;
    Some((kind, content))
}

fn schema(mut content: &[u8]) -> Option<Record<'_>> {
    let id = u16::from_le_bytes(array(&mut content)?);
    let (_name, _encoding) = (sized(&mut content)?, sized(&mut content)?);
    Some(Record::Schema { id, text: sized(&mut content)? })
}

fn channel(mut content: &[u8]) -> Option<Record<'_>> {
    let (id, schema_id) = (array(&mut content)?, array(&mut content)?);
    let topic = text(&mut content)?;
    let (_encoding, mut pairs) = (sized(&mut content)?, sized(&mut content)?);
    let mut metadata = HashMap::new();
    while !pairs.is_empty() {
        metadata.insert(text(&mut pairs)?, text(&mut pairs)?);
    }
    let (id, schema_id) = (u16::from_le_bytes(id), u16::from_le_bytes(schema_id));
    Some(Record::Channel(Channel { id, schema_id, topic, metadata }))
}

fn message(mut content: &[u8]) -> Option<Record<'_>> {
    let header = MessageHeader {
        channel_id: u16::from_le_bytes(array(&mut content)?),
        sequence: u32::from_le_bytes(array(&mut content)?),
        log_time: u64::from_le_bytes(array(&mut content)?),
        publish_time: u64::from_le_bytes(array(&mut content)?),
    };
    Some(Record::Message(header, content))
}

/// The records of a chunk.
fn decompressed(content: &[u8]) -> Result<Vec<u8>, McapError> {
    let damaged = McapError::Damaged { kind: kind::CHUNK };
    let Some((size, sum, compression, compressed)) = chunk(content) else { return Err(damaged) };
    let mut records = Vec::new();
    match &*compression {
        "" => records.extend(compressed),
        ZSTANDARD => {
            let decoder = StreamingDecoder::new(compressed).map_err(io::Error::other)?;
            decoder.take(size).read_to_end(&mut records)?;
        }
        _ => return Err(McapError::Compression(compression)),
    }
    // A sum of zero is none.
    let is_whole = records.len() as u64 == size && (sum == 0 || CRC.checksum(&records) == sum);
    if is_whole { Ok(records) } else { Err(damaged) }
}

/// Size, sum, compression and compressed bytes.
fn chunk(mut content: &[u8]) -> Option<(u64, u32, String, &[u8])> {
    let _times: [u8; 16] = array(&mut content)?;
    let (size, sum) = (array(&mut content)?, array(&mut content)?);
    let compression = text(&mut content)?;
    let length = u64::from_le_bytes(array(&mut content)?);
    Some((u64::from_le_bytes(size), u32::from_le_bytes(sum), compression, split(&mut content, length)?))
}

fn array<const N: usize>(bytes: &mut &[u8]) -> Option<[u8; N]> {
    let (first, rest) = bytes.split_first_chunk()?;
    *bytes = rest;
    Some(*first)
}

fn split<'a>(bytes: &mut &'a [u8], length: u64) -> Option<&'a [u8]> {
    let (first, rest) = bytes.split_at_checked(usize::try_from(length).ok()?)?;
    *bytes = rest;
    Some(first)
}

fn sized<'a>(bytes: &mut &'a [u8]) -> Option<&'a [u8]> {
    let length = u32::from_le_bytes(array(bytes)?);
    split(bytes, length.into())
}

fn text(bytes: &mut &[u8]) -> Option<String> {
    Some(String::from_utf8_lossy(sized(bytes)?).into_owned())
}
