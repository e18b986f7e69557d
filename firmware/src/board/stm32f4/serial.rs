//! A USART as line of bytes.

use stm32f4xx_hal::gpio::Pull;
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::serial::{Config, Rx, RxListen, Tx, TxISR, TxListen};
use stm32f4xx_hal::{hal_02, nb};

use super::fitted::{LinkPins, LinkPort};
use crate::board::parts::{BAUD, LineError, Receiver, Transmitter};

/// Opens the port and enables the receive interrupt.
pub(super) fn open(
    (usart, (out_pin, in_pin)): (LinkPort, LinkPins),
    rcc: &mut Rcc,
) -> (Rx<LinkPort>, Tx<LinkPort>) {
    // The pull-up holds an open input idle: without it noise is received as bytes.
    let pins = (out_pin, in_pin.internal_resistor(Pull::Up));
    let config = Config::default().baudrate(BAUD.bps());
    let serial =
        usart.serial(pins, config, rcc).expect("the peripheral clock is at least 8 times the baud rate");
    let (tx, mut rx) = serial.split();
    rx.listen();
    (rx, tx)
}

impl Receiver for Rx<LinkPort> {
    fn read(&mut self) -> Result<Option<u8>, LineError> {
        match hal_02::serial::Read::read(self) {
            Ok(byte) => Ok(Some(byte)),
            Err(nb::Error::WouldBlock) => Ok(None),
            Err(nb::Error::Other(_)) => Err(LineError),
        }
    }
}

impl Transmitter for Tx<LinkPort> {
    fn is_empty(&self) -> bool {
        self.is_tx_empty()
    }

    fn write(&mut self, byte: u8) {
        // A transmitter reports no error (RM0090 30.6.1), only that it is busy.
        let _ = hal_02::serial::Write::write(self, byte);
    }

    fn interrupt_when_empty(&mut self, does: bool) {
        if does { self.listen() } else { self.unlisten() }
    }

    fn write_from_any_code(byte: u8) -> bool {
        // SAFETY: interrupts are off and control never returns to the owner of the port.
        #[allow(unsafe_code)]
        let usart = unsafe { LinkPort::steal() };
        let is_empty = usart.sr().read().txe().bit_is_set();
        if is_empty {
            usart.dr().write(|w| w.dr().set(byte.into()));
        }
        is_empty
    }
}
