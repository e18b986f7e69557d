//! The memory of a store: two sectors of flash, and how they are divided.

/// Words of a line: the 256 bits that an STM32H7 programs at once.
pub const LINE_WORDS: usize = 8;
/// A line.
pub type Line = [u32; LINE_WORDS];
/// A line after its sector has been erased.
pub const BLANK: Line = [u32::MAX; LINE_WORDS];

/// Lines of a slot.
pub(super) const SLOT_LINES: usize = 64;
/// Slots of a sector.
pub(super) const SECTOR_SLOTS: usize = 64;
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
