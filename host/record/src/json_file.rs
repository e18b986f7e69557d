//! Files with one JSON object for readers outside of this program.

use std::io::Write;
use std::path::Path;

use lashloop_bench::atomic_file::{WriteError, write_whole};
use serde::Serialize;

/// Writes a value as JSON, as [`write_whole`] does.
///
/// # Errors
/// The directory doesn't exist or can't be written to, or a map in the value has keys that aren't texts.
pub fn write_json(path: &Path, prefix: &str, value: &impl Serialize) -> Result<(), WriteError> {
    write_whole(path, prefix, |file| {
        serde_json::to_writer_pretty(&mut *file, value)?;
        file.write_all(b"\n")
    })
}
