//! What a drive offers, and values that no version has.

use super::super::pins::has;
use crate::prelude::checks::*;

/// A source and a trigger that no version has.
pub(super) const UNNAMED: u8 = 77;

/// Skips a check of a drive without an option.
pub(super) fn needs(client: &Client, capability: Capabilities, lacked: &'static str) -> RuleResult {
    if has(client, capability) { Ok(()) } else { skip(lacked) }
}
