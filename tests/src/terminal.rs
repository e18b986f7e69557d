//! Pseudo-terminals for drives and relays of tests.

use std::fs::File;
use std::path::Path;

pub use lashloop_link::terminal::Terminal;
use lashloop_link::terminal::{self, set_raw};

/// Opens a pseudo-terminal. Dropping it disconnects the line.
///
/// # Panics
/// The system has none left.
#[must_use]
pub fn open() -> Terminal {
    Terminal::open().expect("a pseudo-terminal")
}

/// The terminal as `--device` takes it.
#[must_use]
pub fn device(terminal: &Terminal) -> String {
    terminal.path.display().to_string()
}

/// Opens the near end of a terminal in raw mode, as a host does, without locking it.
///
/// # Panics
/// The path is missing.
#[must_use]
pub fn open_near_end(path: &Path) -> File {
    let near_end = terminal::open_near_end(path).and_then(|end| set_raw(&end, 1, 0).map(|()| end));
    near_end.unwrap_or_else(|error| panic!("{}: {error}", path.display())).into()
}
