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
//! | `memory` | [`Memory`]: two sectors of flash, and how they are divided |
//! | `record` | the lines of a record |
//! | `slots` | [`Store`]: which slot, and the steps of a store |

pub mod entry;
mod memory;
mod record;
mod slots;

pub use memory::{BLANK, LINE_WORDS, Line, Memory, SECTOR_LINES, SECTORS};
pub use record::PAIRS_MAX;
pub use slots::{Progress, Store, StoreError};
