//! A parameter as key and word of a record.
//!
//! The key is that of name and type, and the word of a choice that of its name: firmware with other parameters or laws recalls
//! those that it has, and no value as another one.

use crate::law::{Parameter, Range};

/// Key of a parameter.
#[must_use]
pub const fn key(parameter: &Parameter) -> u32 {
    let kind = match parameter.range {
        Range::U32 { .. } => 1,
        Range::F32 { .. } => 2,
        Range::Choice { .. } => 3,
    };
    hash(kind, parameter.name)
}

/// What a record has for this word of a parameter.
#[must_use]
pub fn stored(range: Range, word: u32) -> u32 {
    match range.choices() {
        Some(names) => names.get(word as usize).map_or(u32::MAX, |name| hash(0, name)),
        None => word,
    }
}

/// The word of a parameter that a record has; `None` for a value that the parameter can't have.
#[must_use]
pub fn recalled(range: Range, stored: u32) -> Option<u32> {
    match range.choices() {
        Some(names) => names.iter().position(|name| hash(0, name) == stored).map(|index| index as u32),
        None => range.word(range.value(stored)).ok(),
    }
}

/// Parameters whose keys are equal don't compile.
pub const fn check_keys(table: &[Parameter], appended: &[Parameter]) {
    let mut keys = [0; crate::law::table::MAX_PARAMETERS];
    let mut at = 0;
    while at < table.len() + appended.len() {
        keys[at] = key(if at < table.len() { &table[at] } else { &appended[at - table.len()] });
        let mut earlier = 0;
        while earlier < at {
            assert!(keys[earlier] != keys[at], "two parameters have one key in the store: rename one");
            earlier += 1;
        }
        at += 1;
    }
}

/// FNV-1a, which a constant can have.
const fn hash(kind: u32, text: &str) -> u32 {
    let (mut hash, mut at) = (0x811c_9dc5 ^ kind, 0);
    while at < text.len() {
        hash = (hash ^ text.as_bytes()[at] as u32).wrapping_mul(0x0100_0193);
        at += 1;
    }
    hash
}
