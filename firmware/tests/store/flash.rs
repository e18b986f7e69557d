//! A simulated flash: programming clears bits, and a cut of the power leaves anything where it worked.

use std::collections::BTreeSet;
use std::sync::{Mutex, MutexGuard};

use lashloop_firmware::store::{BLANK, LINE_WORDS, Line, Memory, SECTOR_LINES, SECTORS};

/// Instants of an erase at which the power may go.
pub const ERASE_INSTANTS: u32 = 16;

/// What the memory is made of.
#[derive(Clone)]
pub struct Cells {
    pub lines: Vec<Line>,
    /// Lines that a code shows as unreadable.
    torn: BTreeSet<usize>,
    /// Instants until the power goes; `None` for a supply that stays.
    left: Option<u32>,
    pub is_dead: bool,
    /// Whether each line has a code, as that of an STM32H7.
    has_code: bool,
    pub refuses: bool,
    /// Words programmed or erased since the start, each an instant.
    pub instants: u32,
    pub erasures: u32,
    random: u64,
}

/// The memory as a store sees it.
pub struct Flash(Mutex<Cells>);

impl Cells {
    pub fn blank(has_code: bool) -> Self {
        let lines = vec![BLANK; SECTORS * SECTOR_LINES];
        let (left, random) = (None, 0x9e37_79b9_7f4a_7c15);
        let (is_dead, refuses, instants, erasures) = (false, false, 0, 0);
        Self { lines, torn: BTreeSet::new(), left, is_dead, has_code, refuses, instants, erasures, random }
    }

    /// The same cells, whose power goes after some instants.
    pub fn cut_after(&self, instants: u32, seed: u64) -> Self {
        let mut cells = self.clone();
        cells.left = Some(instants);
        cells.random ^= seed.wrapping_mul(0xd134_2543_de82_ef95);
        cells
    }

    /// The same cells with power.
    pub fn powered(&self) -> Self {
        Self { left: None, is_dead: false, instants: 0, erasures: 0, ..self.clone() }
    }

    pub fn random(&mut self) -> u32 {
        self.random = self.random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (self.random >> 32) as u32
    }

    /// Lets an instant pass. Returns whether the power has gone in it.
    fn has_gone(&mut self) -> bool {
        self.instants += 1;
        self.is_dead = self.left == Some(0);
        self.left = self.left.map(|left| left.saturating_sub(1));
        self.is_dead
    }

    fn program(&mut self, line: usize, words: &Line) {
        if self.has_code {
            assert_eq!(self.lines[line], BLANK, "line {line} is programmed twice");
        }
        for (at, word) in words.iter().enumerate().take(LINE_WORDS) {
            if self.is_dead || self.refuses {
                return;
            }
            if self.has_gone() {
                self.lines[line][at] = self.random();
                // The code of a line that was cut may agree by chance with what is there, or show that it can't be read.
                if self.has_code && self.random().is_multiple_of(2) {
                    self.torn.insert(line);
                }
            } else {
                self.lines[line][at] &= word;
            }
        }
    }

    fn erase(&mut self, sector: usize) {
        let lines = sector * SECTOR_LINES..(sector + 1) * SECTOR_LINES;
        for _ in 0..ERASE_INSTANTS {
            if self.is_dead {
                return;
            }
            if self.has_gone() {
                // Cells between what they were and blank, and some that are anything.
                for line in lines.clone() {
                    for at in 0..LINE_WORDS {
                        let (some, any) = (self.random(), self.random());
                        let word = &mut self.lines[line][at];
                        *word = if any.is_multiple_of(8) { some } else { *word | some };
                    }
                    if self.has_code && self.random().is_multiple_of(4) {
                        self.torn.insert(line);
                    }
                }
                return;
            }
        }
        self.erasures += 1;
        self.torn.retain(|line| !lines.contains(line));
        self.lines[lines].fill(BLANK);
    }
}

impl Flash {
    /// Leaked, because a store has its memory for good.
    pub fn new(cells: Cells) -> &'static Self {
        Box::leak(Box::new(Self(Mutex::new(cells))))
    }

    pub fn cells(&self) -> MutexGuard<'_, Cells> {
        self.0.lock().expect("no test panicked with it")
    }

    /// Takes the cells out, so that nothing large is leaked.
    pub fn take(&self) -> Cells {
        let mut cells = self.cells();
        let lines = std::mem::take(&mut cells.lines);
        Cells { lines, ..cells.clone() }
    }
}

impl Memory for Flash {
    fn read(&self, line: usize) -> Option<Line> {
        let cells = self.cells();
        (!cells.torn.contains(&line)).then(|| cells.lines[line])
    }

    fn is_blank(&self, first: usize, lines: usize) -> bool {
        (first..first + lines).all(|line| self.read(line) == Some(BLANK))
    }

    fn program(&self, line: usize, words: &Line) {
        self.cells().program(line, words);
    }

    fn erase(&self, sector: usize) {
        self.cells().erase(sector);
    }
}
