//! The ways onto the chip.

use lashloop_bench::scenario::declare::Named as _;
use lashloop_bench::settings;

settings! {
    /// A way onto the chip.
    pub enum Way {
        /// a debug probe, by probe-rs
        "probe" => Probe,
        /// the boot loader in ROM over USB, by dfu-util
        "dfu" => Dfu,
        /// the boot loader in ROM at PA9 and PA10 or PB10 and PB11, by stm32flash
        "uart" => Uart,
    }
}

impl Way {
    /// In the order of trial: a probe needs no boot loader, and a UART is probed by sending bytes to it.
    pub const ALL: [Self; 3] = [Self::Probe, Self::Dfu, Self::Uart];

    #[must_use]
    pub fn name(self) -> &'static str {
        self.choice().name
    }

    #[must_use]
    pub fn meaning(self) -> &'static str {
        self.choice().doc
    }

    /// The program that writes.
    #[must_use]
    pub const fn program(self) -> &'static str {
        match self {
            Self::Probe => "probe-rs",
            Self::Dfu => "dfu-util",
            Self::Uart => "stm32flash",
        }
    }

    /// Where the program is from.
    #[must_use]
    pub const fn package(self) -> &'static str {
        match self {
            Self::Probe => "it from https://probe.rs",
            Self::Dfu => "the package dfu-util",
            Self::Uart => "the package stm32flash",
        }
    }

    /// How to get from any state of the flash to a running drive.
    #[must_use]
    pub const fn recovery(self) -> &'static str {
        match self {
            Self::Probe => {
                "the flash may be incomplete; connect the probe and call again: it needs no firmware on the chip"
            }
            Self::Dfu | Self::Uart => {
                "the flash may be incomplete; hold BOOT0 high during a reset and call again: the boot loader is in ROM and \
                 can't be overwritten"
            }
        }
    }
}
