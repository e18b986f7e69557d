//! Reads the records of a file, those of its chunks included.

use std::borrow::Cow;
use std::io::{self, Read};

use lz4_flex::frame::FrameDecoder;

use super::{
    Attachment, CRC32, Channel, ContainerError, HEAD, LZ4, MAGIC, MessageHead, Schema, opcode, split_record,
};

/// A record of a file, chunks resolved.
pub(in crate::samples) enum Entry<'a> {
    Header { profile: &'a str },
    Schema { id: u16, schema: Schema<'a> },
    Channel { id: u16, channel: Channel<'a> },
    Message { head: MessageHead, data: &'a [u8] },
    Attachment(Attachment<'a>),
}

/// How a file ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::samples) enum End {
    /// By the end of its data. What follows repeats schemas and channels.
    Data,
    /// Behind a whole record.
    Record,
    /// Within a record.
    Torn,
}

/// Bytes of the record that ends the data: their checksum.
const CHECKSUM_LEN: usize = 4;

/// Largest record, and largest content of a chunk, in bytes. The record of a run that writes a million steps at once has
/// chunks of this size; a damaged length, or a chunk that unpacks to more than anyone writes, must not fill the memory.
const LARGEST: u64 = 448 << 20;

/// Passes the entries of the data of a file of `length` bytes to `take`, up to the first error of either.
///
/// # Errors
/// The file can't be read, is not MCAP or is damaged, or `take` fails.
pub(in crate::samples) fn read<E: From<ContainerError> + From<io::Error>>(
    mut file: impl Read,
    length: u64,
    mut take: impl FnMut(Entry<'_>) -> Result<(), E>,
) -> Result<End, E> {
    let (mut magic, mut content) = (Vec::new(), Vec::new());
    file.by_ref().take(MAGIC.len() as u64).read_to_end(&mut magic)?;
    if magic != MAGIC {
        return Err(ContainerError::Magic.into());
    }
    let mut rest = length.saturating_sub(MAGIC.len() as u64);
    while let Some(behind) = rest.checked_sub(HEAD as u64) {
        let mut head = [0; HEAD];
        file.read_exact(&mut head)?;
        let [opcode, length @ ..] = head;
        let length = u64::from_le_bytes(length);
        let Some(behind) = behind.checked_sub(length) else { return Ok(End::Torn) };
        // What a power failure leaves of a page, before its content: it may be long.
        if opcode == opcode::NONE {
            return Ok(End::Torn);
        }
        if length > LARGEST {
            return Err(ContainerError::Large { bytes: length, limit: LARGEST }.into());
        }
        content.clear();
        if file.by_ref().take(length).read_to_end(&mut content)? as u64 != length {
            return Ok(End::Torn);
        }
        rest = behind;
        match opcode {
            opcode::DATA_END if content.len() == CHECKSUM_LEN => return Ok(End::Data),
            opcode::DATA_END => return Ok(End::Torn),
            opcode::CHUNK => {
                let chunk = chunk(&content)?;
                let mut inside = &chunk[..];
                while let Some((opcode, content, behind)) = split_record(inside) {
                    inside = behind;
                    pass(opcode, content, &mut take)?;
                }
                if !inside.is_empty() {
                    return Err(ContainerError::Length.into());
                }
            }
            opcode => pass(opcode, &content, &mut take)?,
        }
    }
    Ok(if rest == 0 { End::Record } else { End::Torn })
}

fn pass<E: From<ContainerError>>(
    opcode: u8,
    content: &[u8],
    take: &mut impl FnMut(Entry<'_>) -> Result<(), E>,
) -> Result<(), E> {
    match entry(opcode, content) {
        Some(Some(entry)) => take(entry),
        Some(None) => Ok(()),
        None => Err(ContainerError::Short { opcode }.into()),
    }
}

/// The entry of a record; `Some(None)` is of another kind, and `None` is too short.
fn entry(opcode: u8, mut content: &[u8]) -> Option<Option<Entry<'_>>> {
    let content = &mut content;
    Some(Some(match opcode {
        opcode::HEADER => Entry::Header { profile: take_text(content)? },
        opcode::SCHEMA => {
            let (id, name, encoding) = (take_u16(content)?, take_text(content)?, take_text(content)?);
            let length = take_u32(content)? as usize;
            Entry::Schema { id, schema: Schema { name, encoding, data: content.get(..length)? } }
        }
        opcode::CHANNEL => {
            let (id, schema, topic) = (take_u16(content)?, take_u16(content)?, take_text(content)?);
            let encoding = take_text(content)?;
            let length = take_u32(content)? as usize;
            let mut pairs = content.get(..length)?;
            let mut metadata = Vec::new();
            while !pairs.is_empty() {
                metadata.push((take_text(&mut pairs)?, take_text(&mut pairs)?));
            }
            Entry::Channel { id, channel: Channel { schema, topic, encoding, metadata } }
        }
        opcode::ATTACHMENT => {
            let (log_time, _create_time) = (take_u64(content)?, take_u64(content)?);
            let (name, media_type) = (take_text(content)?, take_text(content)?);
            let length = usize::try_from(take_u64(content)?).ok()?;
            Entry::Attachment(Attachment { log_time, name, media_type, data: content.get(..length)? })
        }
        opcode::MESSAGE => {
            let head = MessageHead {
                channel: take_u16(content)?,
                sequence: take_u32(content)?,
                log_time: take_u64(content)?,
                publish_time: take_u64(content)?,
            };
            Entry::Message { head, data: content }
        }
        _ => return Some(None),
    }))
}

/// The records of a chunk.
fn chunk(mut content: &[u8]) -> Result<Cow<'_, [u8]>, ContainerError> {
    fn fields<'a>(content: &mut &'a [u8]) -> Option<(u64, u32, &'a str, &'a [u8])> {
        let _times = (take_u64(content)?, take_u64(content)?);
        let (length, crc) = (take_u64(content)?, take_u32(content)?);
        let (compression, compressed) = (take_text(content)?, take_u64(content)?);
        // To the last byte: a damaged length of the chunk would begin the next record in the wrong place.
        (content.len() as u64 == compressed).then_some((length, crc, compression, *content))
    }
    let (length, crc, compression, stored) =
        fields(&mut content).ok_or(ContainerError::Short { opcode: opcode::CHUNK })?;
    if length > LARGEST {
        return Err(ContainerError::Large { bytes: length, limit: LARGEST });
    }
    let records = match compression {
        "" => Cow::Borrowed(stored),
        LZ4 => {
            let mut records = Vec::new();
            FrameDecoder::new(stored).take(length).read_to_end(&mut records).map_err(ContainerError::Lz4)?;
            Cow::Owned(records)
        }
        _ => return Err(ContainerError::Compression { name: compression.to_owned() }),
    };
    if records.len() as u64 != length {
        return Err(ContainerError::Length);
    }
    if crc != 0 && CRC32.checksum(&records) != crc {
        return Err(ContainerError::Checksum);
    }
    Ok(records)
}

/// Takes bytes off the front; `None` if they are too few.
fn take<const N: usize>(bytes: &mut &[u8]) -> Option<[u8; N]> {
    let (first, rest) = bytes.split_first_chunk()?;
    *bytes = rest;
    Some(*first)
}

fn take_u16(bytes: &mut &[u8]) -> Option<u16> {
    take(bytes).map(u16::from_le_bytes)
}

fn take_u32(bytes: &mut &[u8]) -> Option<u32> {
    take(bytes).map(u32::from_le_bytes)
}

fn take_u64(bytes: &mut &[u8]) -> Option<u64> {
    take(bytes).map(u64::from_le_bytes)
}

fn take_text<'a>(bytes: &mut &'a [u8]) -> Option<&'a str> {
    let length = take_u32(bytes)? as usize;
    let (text, rest) = bytes.split_at_checked(length)?;
    *bytes = rest;
    std::str::from_utf8(text).ok()
}
