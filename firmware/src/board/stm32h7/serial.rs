//! USART3 as line of bytes, with its FIFOs.

use stm32h7xx_hal::pac::{USART3, usart1::RegisterBlock};
use stm32h7xx_hal::prelude::*;
use stm32h7xx_hal::rcc::{CoreClocks, rec};
use stm32h7xx_hal::serial::{Rx, Tx, config::Config};

use super::fitted::LinkPins;
use crate::board::parts::{BAUD, CORE_HZ, LineError, Receiver, Transmitter};

/// The divider of the peripheral's 42 MHz that is nearest to the rate. The HAL rounds down.
const DIVIDER: u32 = (CORE_HZ / 4 + BAUD / 2) / BAUD;

/// Opens the port and enables the receive interrupt.
pub(super) fn open(
    (usart, block): (USART3, rec::Usart3),
    pins: LinkPins,
    clocks: &CoreClocks,
) -> (Rx<USART3>, Tx<USART3>) {
    let config = Config::new((CORE_HZ / 4 / DIVIDER).Hz());
    let serial = usart.serial(pins, config, block, clocks).expect("a full-duplex port");
    let (tx, mut rx) = serial.split();
    rx.listen();
    (rx, tx)
}

/// Registers of the port: status and data.
fn registers() -> &'static RegisterBlock {
    // SAFETY: receiver and transmitter, which own the port, use flags and data register of their own.
    #[allow(unsafe_code)]
    unsafe {
        &*USART3::ptr()
    }
}

impl Receiver for Rx<USART3> {
    fn read(&mut self) -> Result<Option<u8>, LineError> {
        let status = registers().isr.read();
        let is_wrong = status.fe().bit_is_set() || status.nf().bit_is_set();
        if is_wrong || status.ore().bit_is_set() {
            registers().icr.write(|w| w.fecf().clear().ncf().clear().orecf().clear());
            if is_wrong {
                // A byte with an error is in the FIFO like any other. Reading it shows the flags of the next one.
                let _ = registers().rdr.read();
            }
            return Err(LineError);
        }
        Ok(status.rxne().bit_is_set().then(|| registers().rdr.read().rdr().bits() as u8))
    }
}

impl Transmitter for Tx<USART3> {
    fn is_empty(&self) -> bool {
        registers().isr.read().txe().bit_is_set()
    }

    fn write(&mut self, byte: u8) {
        registers().tdr.write(|w| w.tdr().bits(byte.into()));
    }

    fn interrupt_when_empty(&mut self, does: bool) {
        if does { self.listen() } else { self.unlisten() }
    }

    fn write_from_any_code(byte: u8) -> bool {
        let is_empty = registers().isr.read().txe().bit_is_set();
        if is_empty {
            registers().tdr.write(|w| w.tdr().bits(byte.into()));
        }
        is_empty
    }
}
