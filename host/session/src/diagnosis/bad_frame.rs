//! What a frame is that isn't a message of a drive.

use std::fmt;

use lashloop_protocol::hex::Hex;
use lashloop_protocol::layout::FieldType;
use lashloop_protocol::wire::BodyError;
use lashloop_protocol::{DriveMessage, FrameError, HostMessage, MAX_BODY, Message, Numbered, cobs, frame};

use crate::text::printable;

/// Generator polynomial of CRC-32/ISO-HDLC, the checksum of Ethernet and zlib, reflected.
const ISO_HDLC: u32 = 0xedb8_8320;

/// What a bad frame is.
pub(super) enum BadFrame {
    /// A good frame of a host.
    OfHost(Numbered<HostMessage>),
    /// A whole frame that isn't a message of a drive.
    Refused(Refusal),
    /// A checksum that another rule explains.
    Crc(CrcVariant),
    /// Damaged.
    Damaged,
}

/// A usual mistake in a checksum.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CrcVariant {
    /// The most significant byte is first.
    MostSignificantFirst,
    /// CRC-32/ISO-HDLC instead of CRC-32/ISCSI.
    IsoHdlc,
    /// The final xor is omitted.
    WithoutFinalXor,
}

/// A whole frame that isn't a message of a drive, and why.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Refusal {
    /// Why.
    pub reason: BodyError,
    body: [u8; MAX_BODY],
    body_len: usize,
}

impl BadFrame {
    /// `stuffed` are the bytes between two delimiters.
    pub(super) fn of(stuffed: &[u8], error: &FrameError) -> Self {
        let mut copy = [0; frame::MAX_FRAME - 1];
        let Some(copy) = copy.get_mut(..stuffed.len()) else { return Self::Damaged };
        copy.copy_from_slice(stuffed);
        match error {
            FrameError::Body(reason) => match frame::open(copy) {
                Ok(body) => match HostMessage::decode_body(body) {
                    Ok(message) => Self::OfHost(message),
                    Err(_) => Self::Refused(Refusal::new(*reason, body)),
                },
                Err(_) => Self::Damaged,
            },
            FrameError::Crc { expected, found } => {
                let body = cobs::unstuff(copy).and_then(|unstuffed| unstuffed.split_last_chunk::<4>());
                match body.and_then(|(body, _)| CrcVariant::of(body, *expected, *found)) {
                    Some(variant) => Self::Crc(variant),
                    None => Self::Damaged,
                }
            }
            _ => Self::Damaged,
        }
    }
}

impl CrcVariant {
    fn of(body: &[u8], expected: u32, found: u32) -> Option<Self> {
        match found {
            _ if found.swap_bytes() == expected => Some(Self::MostSignificantFirst),
            _ if !found == expected => Some(Self::WithoutFinalXor),
            _ if found == iso_hdlc(body) => Some(Self::IsoHdlc),
            _ => None,
        }
    }
}

fn iso_hdlc(body: &[u8]) -> u32 {
    let bit = |crc: u32, _| (crc >> 1) ^ if crc & 1 == 1 { ISO_HDLC } else { 0 };
    !body.iter().fold(u32::MAX, |crc, byte| (0..8).fold(crc ^ u32::from(*byte), bit))
}

impl fmt::Display for CrcVariant {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            Self::MostSignificantFirst => {
                "the firmware sends the CRC with its most significant byte first; send it least significant first"
            }
            Self::IsoHdlc => {
                "the firmware uses CRC-32/ISO-HDLC (polynomial 0x04c11db7); use CRC-32/ISCSI (0x1edc6f41)"
            }
            Self::WithoutFinalXor => "the firmware omits the final xor of the CRC; invert all bits at its end",
        })
    }
}

impl Refusal {
    fn new(reason: BodyError, body: &[u8]) -> Self {
        let mut kept = [0; MAX_BODY];
        let body_len = body.len().min(MAX_BODY);
        kept[..body_len].copy_from_slice(&body[..body_len]);
        Self { reason, body: kept, body_len }
    }

    /// Whether it is an `Identity`.
    pub(super) fn is_identity(&self) -> bool {
        self.body.first() == Some(&0x81)
    }

    /// The bytes of a field.
    fn field(&self, message: &str, field: &str) -> Option<(FieldType, &[u8])> {
        let layout = DriveMessage::LAYOUTS.iter().find(|layout| layout.name == message)?;
        let field = layout.fields.iter().find(|layout| layout.name == field)?;
        Some((field.ty, field.bytes(&self.body[..self.body_len])?))
    }
}

/// The message, the field and its value, as in "Identity with state 9, no value of State".
impl fmt::Display for Refusal {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.reason {
            BodyError::UnknownKind { kind, .. } => {
                write!(out, "a message of kind {kind:#04x}, which this bench doesn't know")
            }
            BodyError::OtherDirection { kind } => {
                write!(out, "a message of kind {kind:#04x}, which no drive sends")
            }
            BodyError::Length { name, shortest, found } => {
                write!(out, "{name} with a body of {found} bytes; it has at least {shortest}")
            }
            BodyError::Elements { name, longest, step, found } => {
                write!(
                    out,
                    "{name} with a body of {found} bytes; it has at most {longest}, in steps of {step}"
                )
            }
            BodyError::Value { name, field } => {
                write!(out, "{name} with {field} ")?;
                match self.field(name, field) {
                    Some((FieldType::Enum(list), [byte, ..])) => {
                        write!(out, "{byte}, no value of {}", list.name)
                    }
                    Some((FieldType::Status { .. }, [byte, ..])) => {
                        write!(out, "{byte:#04x}, a state of 0")
                    }
                    Some((FieldType::Text, text)) => {
                        let text = String::from_utf8_lossy(text);
                        let text = text.trim_end_matches('\0');
                        write!(out, "\"{}\", no UTF-8 padded with zeros", printable(text))
                    }
                    Some((_, bytes)) => write!(out, "{:#}, no value of its type", Hex(bytes)),
                    None => out.write_str("of no value of its type"),
                }
            }
        }
    }
}
