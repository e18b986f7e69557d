//! Numbers of sessions.

use std::time::{SystemTime, UNIX_EPOCH};

/// A session number that no earlier session on this machine had, up to chance.
#[must_use]
pub fn session_number() -> u32 {
    let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    (now.as_nanos() as u32) ^ std::process::id().rotate_left(16)
}
