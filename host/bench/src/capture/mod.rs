//! What passed on the line, kept as a pcapng file that Wireshark, tshark and `lashloop decode` read.
//!
//! One packet is one frame as it was on the wire: COBS code first, delimiter last, damaged bytes as they came. A
//! delimiter without a frame, which a sender uses to clear the line, is a packet of one byte. Times are nanoseconds:
//! of a frame to the drive when it was handed to the link, of a frame from the drive when its delimiter had been read.
//!
//! | module | does |
//! |---|---|
//! | [`pcapng`] | packets become blocks |
//! | `file` | blocks reach the file, never half of one |
//! | [`recorder`] | packets go from the loop to the thread that writes |
//! | [`splitter`] | a stream becomes pieces that end with a delimiter |
//! | [`reader`] | a file becomes packets again, whoever wrote it |
//!
//! The middleware that captures a link is [`crate::capture::link`].

mod file;
pub mod link;
pub mod pcapng;
pub mod reader;
pub mod recorder;
pub mod splitter;

pub use recorder::{Capture, Recorder, WhenFull, create};
pub use splitter::Splitter;
