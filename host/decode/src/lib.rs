//! The bytes of a line: captured, and as text: position, direction, fields and errors.
//!
//! | module | does |
//! |---|---|
//! | [`capture`] | the bytes of a line, recorded and read |
//! | `entry` | one frame of a stream or of a capture |
//! | `reader` | splits streams and captures into entries |
//! | `subscription` | names telemetry values, by the descriptions and the subscription in the same stream |
//! | [`series`] | the control steps of a capture as columns |
//! | [`message`] | decodes a message of either direction, for streams that mix both |
//! | [`table`], [`json`] | formats an entry as a line of text, or of JSON |
//!
//! [`lashloop_protocol::Decoder`], the decoder of the bench and of the drive, accepts and rejects the frames.

#![forbid(unsafe_code)]

pub mod capture;
mod entry;
pub mod json;
pub mod message;
mod reader;
pub mod series;
mod subscription;
pub mod table;

pub use entry::{DecodedMessage, Entry, Location};
pub use reader::{PacketReader, StreamReader};
pub use subscription::Label;
