//! A file of settings as text.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use super::error::ScenarioError;
use crate::regular_file;

/// Largest file in bytes. A long reference is a table in a file of its own, and a scenario of this size has 10,000 faults.
const LARGEST: u64 = 1 << 20;

/// Reads a file in UTF-8. `kind` is what it is in messages, such as `scenario`.
pub(super) fn read(path: &Path, kind: &str) -> Result<String, ScenarioError> {
    let unusable = |reason: String| ScenarioError::Unusable { path: path.to_owned(), reason };
    let cannot_read = |error: io::Error| unusable(format!("can't be read: {error}"));
    if let Some(other) = regular_file::other_kind(path).map_err(cannot_read)? {
        let remedy = match other {
            "a folder" => "name a file in it".to_owned(),
            "a pipe" => format!("write the {kind} to a file first"),
            _ => "name a file".to_owned(),
        };
        return Err(unusable(format!("is {other}; {remedy}")));
    }
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(cannot_read)?;
    file.take(LARGEST + 1).read_to_end(&mut bytes).map_err(cannot_read)?;
    if bytes.len() as u64 > LARGEST {
        return Err(unusable(format!("is larger than 1 MiB, so it isn't a {kind}; name a TOML file")));
    }
    decode(bytes).map_err(unusable)
}

fn decode(bytes: Vec<u8>) -> Result<String, String> {
    // In UTF-16 every second byte of a TOML text is zero, with a byte order mark or without.
    if bytes.starts_with(&[0xff, 0xfe])
        || bytes.starts_with(&[0xfe, 0xff])
        || bytes.iter().take(64).any(|&byte| byte == 0)
    {
        return Err("is in UTF-16 or binary; save it as text in UTF-8".to_owned());
    }
    String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        let line = 1 + error.as_bytes()[..at].iter().filter(|&&byte| byte == b'\n').count();
        format!("is not in UTF-8 in line {line}; save it as text in UTF-8")
    })
}

/// A text without the byte order mark that some editors write.
pub(super) fn without_mark(text: &str) -> &str {
    text.strip_prefix('\u{feff}').unwrap_or(text)
}
