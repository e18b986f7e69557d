//! Blocks of a chip that a board chooses among.

use serde::Deserialize;

/// A timer that counts encoders, in the order of the models of both families.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "UPPERCASE")]
#[expect(missing_docs, reason = "names of the data sheet")]
pub enum Timer {
    Tim2,
    Tim3,
    Tim4,
    Tim5,
}

/// A serial port, in the order of the models of both families.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "UPPERCASE")]
#[expect(missing_docs, reason = "names of the data sheet")]
pub enum SerialPort {
    Usart1,
    Usart2,
    Usart3,
    Uart4,
    Uart5,
    Usart6,
    Uart7,
    Uart8,
}

/// A serial interface, in the order of the models of both families.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "UPPERCASE")]
#[expect(missing_docs, reason = "names of the data sheet")]
pub enum SerialInterface {
    Spi1,
    Spi2,
    Spi3,
    Spi4,
    Spi5,
    Spi6,
}
