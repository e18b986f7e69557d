//! The memory of the store: the last two sectors of the second bank (RM0433 4.3.4).
//!
//! The core runs from the first bank, and so doesn't stand still while the second one is programmed, or erased.
//!
//! Each line of 256 bits has a code. A line whose programming was cut may have two wrong bits, and reading it is then a bus fault
//! (RM0433 4.7.7). [`readable`] reads with FAULTMASK set and BFHFNMIGN: the fault is ignored, and a flag of the bank reports it.

use core::arch::asm;
use core::ptr;

use cortex_m::peripheral::SCB;
use stm32h7xx_hal::pac::FLASH;
use stm32h7xx_hal::pac::flash::BANK;

use crate::store::{LINE_WORDS, Line, Memory};

/// Address of the first sector, and its number in the bank; the other one follows.
const FIRST: (usize, u8) = (0x081c_0000, 6);
/// Cycles between two looks at an operation, which may last for seconds.
const PAUSE_CYCLES: u32 = 100;
const KEYS: [u32; 2] = [0x4567_0123, 0xcdef_89ab];
/// All flags of an operation before, some of which would keep the next one from starting.
const FLAGS: u32 = 0x0fef_0000;
/// 64 bits at once.
const PARALLELISM: u8 = 0b11;
/// BFHFNMIGN of SCB_CCR.
const IGNORE_BUS_FAULTS: u32 = 1 << 8;

/// The memory.
pub struct Flash;

fn place(line: usize) -> *mut u32 {
    (FIRST.0 + line * size_of::<Line>()) as *mut u32
}

fn bank() -> &'static BANK {
    // SAFETY: nothing else uses the registers of the second bank.
    #[allow(unsafe_code)]
    unsafe { &*FLASH::ptr() }.bank2()
}

fn clear_flags(bank: &BANK) {
    // SAFETY: a bit clears a flag.
    #[allow(unsafe_code)]
    bank.ccr.write(|w| unsafe { w.bits(FLAGS) });
}

/// Unlocks the memory for an operation, waits for its end, and locks it again.
fn unlocked(operation: impl FnOnce(&BANK)) {
    let bank = bank();
    wait(bank);
    if bank.cr.read().lock().bit_is_set() {
        for key in KEYS {
            // SAFETY: a key has any bits.
            #[allow(unsafe_code)]
            bank.keyr.write(|w| unsafe { w.keyr().bits(key) });
        }
    }
    clear_flags(bank);
    operation(bank);
    cortex_m::asm::dsb();
    wait(bank);
    bank.cr.modify(|_, w| w.pg().clear_bit().ser().clear_bit());
    bank.cr.modify(|_, w| w.lock().set_bit());
}

/// Until the queue of the bank is empty.
fn wait(bank: &BANK) {
    while bank.sr.read().qw().bit_is_set() {
        cortex_m::asm::delay(PAUSE_CYCLES);
    }
}

/// What reads the memory, without bus faults; `None` if a line can't be read.
fn readable<T>(read: impl FnOnce() -> T) -> Option<T> {
    let bank = bank();
    clear_flags(bank);
    // SAFETY: the mask is on for the reading alone, and nothing in between can fault but the reading.
    #[allow(unsafe_code)]
    unsafe {
        (*SCB::PTR).ccr.modify(|it| it | IGNORE_BUS_FAULTS);
        asm!("cpsid f", "dsb", "isb", options(nostack));
    }
    let found = read();
    // SAFETY: as above.
    #[allow(unsafe_code)]
    unsafe {
        asm!("dsb", "cpsie f", options(nostack));
        (*SCB::PTR).ccr.modify(|it| it & !IGNORE_BUS_FAULTS);
    }
    bank.sr.read().dbeccerr().bit_is_clear().then_some(found)
}

impl Memory for Flash {
    fn read(&self, line: usize) -> Option<Line> {
        // SAFETY: the sectors are readable, and no variable is there: `memory.x` ends before them.
        #[allow(unsafe_code)]
        readable(|| unsafe { ptr::read_volatile(place(line).cast()) })
    }

    fn is_blank(&self, first: usize, lines: usize) -> bool {
        let words = lines * LINE_WORDS;
        // SAFETY: as in `read`.
        #[allow(unsafe_code)]
        let is_word_blank = |at| unsafe { ptr::read_volatile(place(first).add(at)) } == u32::MAX;
        readable(|| (0..words).all(is_word_blank)) == Some(true)
    }

    fn program(&self, line: usize, words: &Line) {
        unlocked(|bank| {
            // SAFETY: every parallelism exists.
            #[allow(unsafe_code)]
            bank.cr.modify(|_, w| unsafe { w.psize().bits(PARALLELISM) }.pg().set_bit());
            for (at, word) in words.iter().enumerate() {
                // SAFETY: as in `read`.
                #[allow(unsafe_code)]
                unsafe {
                    ptr::write_volatile(place(line).add(at), *word);
                }
            }
        });
    }

    fn erase(&self, sector: usize) {
        unlocked(|bank| {
            // SAFETY: the number is that of a sector of the store.
            #[allow(unsafe_code)]
            bank.cr.modify(|_, w| unsafe {
                w.psize().bits(PARALLELISM).ser().set_bit().snb().bits(FIRST.1 + sector as u8)
            });
            bank.cr.modify(|_, w| w.start().set_bit());
        });
    }
}
