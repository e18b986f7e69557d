//! Parameters that survive power-off: records in two sectors of flash.
//!
//! Each sector is a row of slots of 2 KiB, each slot a row of *lines* of 32 bytes, which is what one chip programs at once and
//! covers by one code. A record fills a blank slot from its second line on; its first line, with the check value, comes last. The
//! valid record with the highest sequence number counts. So a loss of power at any instant leaves the record before or the new
//! one. A slot is programmed once, and a line of it never again before its sector has been erased.
//!
//! A store takes the next blank slot, in the other sector if its own is full. Erasing takes a second or two, and may halt the core:
//! [`Store::open`] does it at power-up, for a sector that isn't blank and doesn't hold the record that counts.
//!
//! | module | is |
//! |---|---|
//! | `entry` | a parameter as key and word, for firmware that has other parameters |
//! | `record` | the lines of a record |
//! | `slots` | [`Store`]: which slot, and the steps of a store |

pub mod entry;
mod record;
mod slots;

pub use record::{BLANK, LINE_WORDS, Line, PAIRS_MAX};
pub use slots::{Progress, Store, StoreError};

/// Lines of a slot.
const SLOT_LINES: usize = 64;
/// Slots of a sector.
const SECTOR_SLOTS: usize = 64;
/// Lines of a sector: 128 KiB.
pub const SECTOR_LINES: usize = SECTOR_SLOTS * SLOT_LINES;
/// Sectors of a store.
pub const SECTORS: usize = 2;

/// Two sectors of flash, whose lines are numbered through both.
pub trait Memory: Sync {
    /// A line; `None` if its code shows that it can't be read, as after a loss of power while it was programmed.
    fn read(&self, line: usize) -> Option<Line>;

    /// Whether lines are readable and blank. A start calls it for a whole sector.
    fn is_blank(&self, first: usize, lines: usize) -> bool;

    /// Programs a blank line. Whether it has succeeded is shown by [`Self::read`].
    fn program(&self, line: usize, words: &Line);

    /// Erases a sector. The core may stand still for two seconds, so no watchdog may run.
    fn erase(&self, sector: usize);
}
