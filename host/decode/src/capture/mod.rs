//! Captures of the link as pcapng files, which Wireshark, tshark and `lashloop decode` read.
//!
//! A packet is one frame as on the wire: COBS code first, delimiter last, damaged bytes unchanged. A delimiter without a
//! frame, which a sender uses to clear the link, is a packet of one byte. Times are in nanoseconds: for a frame to the drive
//! when the link takes it, for a frame from the drive when its delimiter has been read.
//!
//! | module | does |
//! |---|---|
//! | [`pcapng`] | encodes packets as blocks |
//! | [`recorder`] | passes packets from the loop to the thread that writes the file |
//! | [`splitter`] | splits a stream at its delimiters |
//! | [`reader`] | reads packets of any pcapng file |
//!
//! The middleware that captures a link is [`link`].

pub mod link;
pub mod pcapng;
pub mod reader;
pub mod recorder;
pub mod splitter;

pub use recorder::{Capture, Recorder, WhenFull, create};
pub use splitter::Splitter;
