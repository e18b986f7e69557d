//! Which parameters of a set are live.

use super::text::{fail, same_text};
use crate::law::Parameter;

/// The table with the parameters marked that every law of theirs takes live. The table begins with `own` parameters of the
/// drive itself; `live` has the names that each law takes.
#[must_use]
pub const fn mark_live<const N: usize>(
    mut table: [Parameter; N],
    own: usize,
    live: &[&[&str]],
) -> [Parameter; N] {
    let mut takers = [0_u16; N];
    let mut law = 0;
    while law < live.len() {
        let mut next = 0;
        while next < live[law].len() {
            takers[index(&table, own, law, live[law][next])] |= 1 << law;
            next += 1;
        }
        law += 1;
    }
    let mut at = own;
    while at < N {
        table[at].live = takers[at] == table[at].laws;
        at += 1;
    }
    table
}

/// The index of a parameter that this law takes live.
const fn index(table: &[Parameter], own: usize, law: usize, name: &str) -> usize {
    let mut at = 0;
    while at < table.len() {
        if same_text(table[at].name, name) && table[at].laws >> law & 1 != 0 {
            if at < own {
                fail(name, "is a parameter of the drive itself, and a law takes it live");
            }
            return at;
        }
        at += 1;
    }
    fail(name, "is taken live by a law that doesn't have it")
}
