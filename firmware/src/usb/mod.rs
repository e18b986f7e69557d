//! The drive's own USB port: a CDC ACM serial port on any [`UsbBus`](usb_device::bus::UsbBus).
//!
//! | module | concept |
//! |---|---|
//! | `line` | [`UsbLine`]: the drive's bytes in packets, and the state in which the host leaves the port |
//! | `line_selection` | [`LineSelection`]: which of two lines a drive serves |
//! | `lines` | [`Lines`]: the drive between a UART and its USB port |
//! | `serial_number` | the chip's unique id as text |
//!
//! No register is touched here. The board gives the bus; tests give one whose far end is Linux's `cdc_acm`.

mod line;
mod line_selection;
mod lines;
mod serial_number;

pub use line::{HostSide, Identification, PACKET_BYTES, UsbLine};
pub use line_selection::{Line, LineSelection};
pub use lines::{ByteLine, CHUNK_BYTES, Chunk, Lines};
pub use serial_number::{SerialNumber, serial_number};
