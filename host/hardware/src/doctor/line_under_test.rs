//! What the line to a drive is, as far as its properties go.

use std::path::Path;
use std::time::Duration;

use lashloop_bench::device::DeviceChoice;
use lashloop_link::pty;

use super::round_trip;

/// The line to a drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum LineUnderTest<'a> {
    /// A serial port of this machine, with its speed in bit/s.
    SerialPort {
        terminal: &'a Path,
        baud: u32,
    },
    PseudoTerminal,
    /// A pipe, a socket, or the drive in this process.
    Other,
}

impl<'a> LineUnderTest<'a> {
    pub(super) fn new(choice: &'a DeviceChoice, baud: u32) -> Self {
        match choice.terminal() {
            Some(terminal) if terminal.starts_with(pty::DIRECTORY) => Self::PseudoTerminal,
            Some(terminal) => Self::SerialPort { terminal, baud },
            None => Self::Other,
        }
    }

    /// The terminal with the properties of a serial port.
    pub(super) fn terminal(self) -> Option<&'a Path> {
        match self {
            Self::SerialPort { terminal, .. } => Some(terminal),
            Self::PseudoTerminal | Self::Other => None,
        }
    }

    /// The line's name in findings that do not apply.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::SerialPort { .. } => "a serial port",
            Self::PseudoTerminal => "a pseudo-terminal",
            Self::Other => "a line without a terminal",
        }
    }

    /// Time of a control cycle's bytes on the wire; `None` for a line without a baud rate.
    pub(super) fn wire_time(self) -> Option<Duration> {
        match self {
            Self::SerialPort { baud, .. } => Some(round_trip::wire_time(baud)),
            Self::PseudoTerminal | Self::Other => None,
        }
    }
}
