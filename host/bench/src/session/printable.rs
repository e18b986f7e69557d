//! Text of the drive, made safe to print.

/// Replaces control characters: text of the drive goes to a user's terminal and must not control it.
#[must_use]
pub fn printable(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect()
}
