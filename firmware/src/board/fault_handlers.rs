//! Handlers of panics, processor faults and unexpected interrupts: each switches the power stage off, sends one fault
//! report and stops until a reset.

use core::panic::{Location, PanicInfo};

use super::chip::Chip;
use super::pac::Interrupt;
use super::parts::{StageLines as _, Transmitter as _};
use super::{Fitted, device_clock, last_resort, usb_port};
use crate::drive::fault_frame;
use cortex_m::peripheral::{NVIC, Peripherals, SCB};
use cortex_m_rt::{ExceptionFrame, exception};
use lashloop_protocol::enums::FaultCode;
use lashloop_protocol::frame::DELIMITER;

/// Polls of the transmitter before a byte is given up: at 168 MHz about 100 times the duration of a byte.
const POLLS_PER_BYTE: u32 = 20_000;

/// A stack that has overflowed took no frame (ARMv7-M B3.2.15, MSTKERR).
const STACKING_FAILED: u32 = 1 << 4;

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    stop(FaultCode::Panic, info.location().map_or(0, Location::line))
}

// SAFETY: the attribute requires `unsafe` because the handler may interrupt any code; `stop` uses no state besides the
// USART's registers.
#[allow(unsafe_code)]
#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    // SAFETY: reading the status has no effect.
    #[allow(unsafe_code)]
    let has_frame = unsafe { (*SCB::PTR).cfsr.read() } & STACKING_FAILED == 0;
    stop(FaultCode::ProcessorFault, if has_frame { frame.pc() } else { 0 })
}

// SAFETY: as above.
#[allow(unsafe_code)]
#[exception]
unsafe fn DefaultHandler(interrupt: i16) {
    stop(FaultCode::ProcessorFault, interrupt.unsigned_abs().into())
}

/// Switches the power stage off, sends a fault report and stops until a reset.
fn stop(code: FaultCode, detail: u32) -> ! {
    cortex_m::interrupt::disable();
    // First of all: no torque outlives the code that computed it.
    <Fitted as Chip>::StageLines::switch_off();
    // The delimiter ends a frame in transmission.
    send(&[DELIMITER]);
    send(&fault_frame(code, detail, device_clock::now()));
    if usb_port::is_open() {
        Fitted::disconnect_usb();
    }
    // An interrupt that stays enabled and pending would end every sleep at once.
    NVIC::mask(Fitted::LINK);
    NVIC::mask(Interrupt::OTG_FS);
    // SAFETY: interrupts are off, and the owner of SysTick never runs again.
    #[allow(unsafe_code)]
    let mut syst = unsafe { Peripherals::steal() }.SYST;
    syst.disable_interrupt();
    loop {
        // A reset would end the halt that the fault report announced.
        if last_resort::is_running() {
            last_resort::feed();
        } else {
            cortex_m::asm::wfi();
        }
    }
}

/// Transmits until the transmitter accepts no more bytes, as in a panic before the link is open.
fn send(bytes: &[u8]) {
    for byte in bytes {
        if !(0..POLLS_PER_BYTE).any(|_| <Fitted as Chip>::Transmitter::write_from_any_code(*byte)) {
            return;
        }
    }
}
