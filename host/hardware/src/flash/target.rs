//! The chip as its loaders see it.

use std::path::{Path, PathBuf};

use lashloop_link::pty;

/// The chip as its loaders see it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Target {
    /// The chip, as probe-rs names it.
    pub chip: String,
    /// The debug probe, as `VID:PID:SERIAL`; `None` for the only one.
    pub probe: Option<String>,
    /// Whether a probe holds the chip in reset while it connects: no drive has confirmed that its power stage is off.
    pub under_reset: bool,
    /// Terminal at PA9 and PA10 or PB10 and PB11, where the ROM loader listens.
    pub loader_port: Option<PathBuf>,
}

impl Target {
    /// Format of the ROM loader's UART: 8 data bits, even parity, 1 stop bit. A pseudo-terminal has no parity.
    pub(super) fn line_format(port: &Path) -> &'static str {
        let is_pseudo_terminal = port.canonicalize().is_ok_and(|port| port.starts_with(pty::DIRECTORY));
        if is_pseudo_terminal { "8n1" } else { "8e1" }
    }
}
