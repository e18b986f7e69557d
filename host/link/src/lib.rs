//! Anything that carries bytes to a drive and back: a [`Link`].
//!
//! | module | reaches |
//! |---|---|
//! | [`in_process`] | the drive in this process, called directly, with a virtual clock |
//! | [`pty`] | a drive on a pseudo-terminal: the native twin or any other program |
//! | [`serial`] | a drive on a serial port, by the `serialport` crate |
//! | [`child_line`] | a drive that the bench started, on its standard input and output or on a pseudo-terminal |
//! | [`socket`] | the emulator's UART |
//! | [`tcp`] | a drive behind a TCP port |
//! | [`rfc2217`] | a serial port of another machine, by telnet over TCP |
//! | [`reopening`] | a terminal or TCP port that is opened again after it was disconnected |
//! | [`uart_model`] | any of these but a serial port, as slow as a UART |
//!
//! [`terminal`] makes the pseudo-terminal that a drive serves. [`usb_adapter`] identifies a USB serial adapter,
//! [`same_adapter`] compares it after a reconnect, and
//! [`latency_timer`] shortens the time for which it holds received bytes. [`spin`] waits busily where that pays.
//!
//! Every wait has a deadline, and the end of a line is an error of its own: a terminal whose far end is closed otherwise
//! reads as silence forever.

#![forbid(unsafe_code)]
#![warn(missing_docs)]

pub mod child_line;
mod contract;
mod deadline;
mod error;
pub mod in_process;
pub mod latency_timer;
pub mod pty;
pub mod reopening;
pub mod rfc2217;
pub mod same_adapter;
pub mod serial;
pub mod socket;
pub mod spin;
pub mod tcp;
pub mod terminal;
pub mod uart_model;
pub mod usb_adapter;

pub use contract::{Link, TimeBase};
pub use error::LinkError;
