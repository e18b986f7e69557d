//! The end: a panic, a fault of the processor or an interrupt nobody expects. The drive says so in one frame and
//! stops for good; only a reset brings it back.
//!
//! There is no torque to take away: see the [board](super). The host sees the fault, or the silence.

use core::panic::{Location, PanicInfo};

use cortex_m::peripheral::{NVIC, Peripherals};
use cortex_m_rt::{ExceptionFrame, exception};
use lashloop_firmware::drive::fault_frame;
use lashloop_protocol::enums::FaultCode;
use lashloop_protocol::frame::DELIMITER;
use stm32f4xx_hal::pac::{Interrupt, USART2};

/// How often to ask the transmitter whether it is ready for a byte: at 168 MHz some 100 times as long as a byte needs.
const POLLS_PER_BYTE: u32 = 20_000;

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    stop(FaultCode::Panic, info.location().map_or(0, Location::line))
}

// SAFETY: the attribute asks for `unsafe` because the handler may come in the middle of anything; `stop` relies on
// nothing but the USART's registers.
#[allow(unsafe_code)]
#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    stop(FaultCode::ProcessorFault, frame.pc())
}

// SAFETY: as above.
#[allow(unsafe_code)]
#[exception]
unsafe fn DefaultHandler(interrupt: i16) {
    stop(FaultCode::ProcessorFault, interrupt.unsigned_abs().into())
}

/// Says `code` and sleeps until the reset.
fn stop(code: FaultCode, detail: u32) -> ! {
    cortex_m::interrupt::disable();
    // A frame may be on its way: the delimiter closes it.
    send(&[DELIMITER]);
    send(&fault_frame(code, detail));
    // What stays enabled and pending would end every sleep at once.
    NVIC::mask(Interrupt::USART2);
    NVIC::mask(Interrupt::EXTI0);
    // SAFETY: as in `send`: nobody comes back to use SysTick.
    #[allow(unsafe_code)]
    let mut syst = unsafe { Peripherals::steal() }.SYST;
    syst.disable_interrupt();
    loop {
        cortex_m::asm::wfi();
    }
}

/// Sends as long as the transmitter takes bytes. Where it doesn't (a panic before the link is open) we give up.
fn send(bytes: &[u8]) {
    // SAFETY: interrupts are off and we never return to the owner of the USART, so nobody else is using it.
    #[allow(unsafe_code)]
    let usart = unsafe { USART2::steal() };
    for byte in bytes {
        if !(0..POLLS_PER_BYTE).any(|_| usart.sr().read().txe().bit_is_set()) {
            return;
        }
        usart.dr().write(|w| w.dr().set((*byte).into()));
    }
}
