//! From the drive into the boot loader in the ROM of the chip (ST AN2606), by request.
//!
//! The loader expects the chip as after a reset. So the firmware leaves a word where a reset keeps it, resets the chip, which
//! also ends the independent watchdog, and the next start follows the word before it configures anything.

use core::mem::MaybeUninit;
use core::ptr;

use cortex_m::peripheral::{NVIC, SCB};

use super::Fitted;
use super::chip::Chip;
use super::parts::StageLines as _;

/// A word that RAM doesn't hold by chance after power-up.
const REQUEST: u32 = 0x5245_4f4c;

/// Not initialised by the start-up code.
// SAFETY: the section holds this word alone, and every access is by the volatile functions below.
#[allow(unsafe_code)]
#[unsafe(link_section = ".uninit.loader")]
static mut WORD: MaybeUninit<u32> = MaybeUninit::uninit();

/// Resets the chip into its boot loader.
pub fn enter() -> ! {
    cortex_m::interrupt::disable();
    <Fitted as Chip>::StageLines::switch_off();
    // SAFETY: interrupts are off, and nothing else uses the word.
    #[allow(unsafe_code)]
    unsafe {
        ptr::write_volatile(&raw mut WORD, MaybeUninit::new(REQUEST));
    }
    SCB::sys_reset()
}

/// Starts the boot loader if the firmware before the reset was to do so. To be called before anything is configured.
pub(super) fn follow_request(device: &<Fitted as Chip>::Peripherals) {
    // SAFETY: any bits are a `u32`, and this runs once, before the tasks.
    #[allow(unsafe_code)]
    let word = unsafe { ptr::read_volatile((&raw const WORD).cast::<u32>()) };
    if word != REQUEST {
        return;
    }
    // SAFETY: as above. The loader is entered once: after it the firmware starts as after power-up.
    #[allow(unsafe_code)]
    unsafe {
        ptr::write_volatile(&raw mut WORD, MaybeUninit::new(0));
    }
    Fitted::show_rom(device);
    // SAFETY: no task has run: what the start-up code has unmasked is masked again, and the loader, which uses interrupts,
    // takes over stack and processor for good.
    #[allow(unsafe_code)]
    unsafe {
        for register in &(*NVIC::PTR).icer {
            register.write(u32::MAX);
        }
        (*SCB::PTR).vtor.write(Fitted::ROM_VECTORS);
        cortex_m::interrupt::enable();
        cortex_m::asm::bootload(Fitted::ROM as *const u32)
    }
}
