//! The memory of the store: the last two sectors of the chip, each of 128 KiB (RM0090 3.4, RM0390 3.3).
//!
//! An STM32F405 or F446 has one bank of flash: the core stands still while it is programmed, 16 us for a word and at most 100 us
//! (DS8626 table 40), and while it is erased.

use core::ptr;

use stm32f4xx_hal::pac::FLASH;

use crate::store::{LINE_WORDS, Line, Memory};

/// Address of the first sector, and its number in FLASH_CR; the other one follows.
#[cfg(feature = "stm32f405")]
const FIRST: (usize, u8) = (0x080c_0000, 10);
#[cfg(feature = "stm32f429")]
const FIRST: (usize, u8) = (0x081c_0000, 0b11010);
#[cfg(feature = "stm32f446")]
const FIRST: (usize, u8) = (0x0804_0000, 6);

/// Cycles between two looks at an operation, which may last for seconds.
const PAUSE_CYCLES: u32 = 100;
const KEYS: [u32; 2] = [0x4567_0123, 0xcdef_89ab];
/// Errors of an operation before, which would keep the next one from starting.
const ERRORS: u32 = 0xf2;

/// The memory.
pub struct Flash;

fn place(line: usize) -> *mut u32 {
    (FIRST.0 + line * size_of::<Line>()) as *mut u32
}

/// Unlocks the memory for an operation, and locks it again.
fn unlocked(operation: impl FnOnce(&FLASH)) {
    // SAFETY: the start of the clocks alone uses the registers too, and none of these, at another time.
    #[allow(unsafe_code)]
    let flash = unsafe { FLASH::steal() };
    wait(&flash);
    if flash.cr().read().lock().is_locked() {
        for key in KEYS {
            // SAFETY: a key has any bits.
            #[allow(unsafe_code)]
            flash.keyr().write(|w| unsafe { w.key().bits(key) });
        }
    }
    // SAFETY: a bit clears a flag or does nothing.
    #[allow(unsafe_code)]
    flash.sr().write(|w| unsafe { w.bits(ERRORS) });
    operation(&flash);
    flash.cr().write(|w| w.lock().locked());
}

fn wait(flash: &FLASH) {
    while flash.sr().read().bsy().is_busy() {
        cortex_m::asm::delay(PAUSE_CYCLES);
    }
}

impl Memory for Flash {
    fn read(&self, line: usize) -> Option<Line> {
        // SAFETY: the sectors are readable, and no variable is there: `memory.x` ends before them.
        #[allow(unsafe_code)]
        Some(unsafe { ptr::read_volatile(place(line).cast()) })
    }

    fn is_blank(&self, first: usize, lines: usize) -> bool {
        let words = lines * LINE_WORDS;
        // SAFETY: as in `read`.
        #[allow(unsafe_code)]
        (0..words).all(|at| unsafe { ptr::read_volatile(place(first).add(at)) } == u32::MAX)
    }

    fn program(&self, line: usize, words: &Line) {
        unlocked(|flash| {
            // 32 bits at once, from 2.7 V on.
            flash.cr().modify(|_, w| w.psize().psize32().pg().set_bit());
            for (at, word) in words.iter().enumerate() {
                // SAFETY: as in `read`.
                #[allow(unsafe_code)]
                unsafe {
                    ptr::write_volatile(place(line).add(at), *word);
                }
                cortex_m::asm::dsb();
                wait(flash);
            }
        });
    }

    fn erase(&self, sector: usize) {
        unlocked(|flash| {
            // A boot loader may have left the cache on, which would keep what was there.
            flash.acr().modify(|_, w| w.dcen().disabled());
            // SAFETY: the number is that of a sector of the store.
            #[allow(unsafe_code)]
            flash.cr().modify(|_, w| unsafe {
                w.psize().psize32().ser().set_bit().snb().bits(FIRST.1 + sector as u8)
            });
            flash.cr().modify(|_, w| w.strt().start());
            cortex_m::asm::dsb();
            wait(flash);
            flash.acr().modify(|_, w| w.dcrst().reset());
            flash.acr().modify(|_, w| w.dcrst().no_reset());
        });
    }
}
