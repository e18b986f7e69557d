//! The ways onto the chip.

use lashloop_bench::supervisor::find_program;

/// A way onto the chip.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Way {
    /// A debug probe, by probe-rs.
    Probe,
    /// The boot loader in the chip's ROM over USB, by dfu-util.
    Dfu,
    /// The boot loader in the chip's ROM over a UART, by stm32flash.
    Uart,
}

impl Way {
    /// In the order of trial: a probe needs no boot loader, and a UART is probed by sending bytes to it.
    pub const ALL: [Self; 3] = [Self::Probe, Self::Dfu, Self::Uart];

    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Probe => "probe",
            Self::Dfu => "dfu",
            Self::Uart => "uart",
        }
    }

    #[must_use]
    pub const fn meaning(self) -> &'static str {
        match self {
            Self::Probe => "a debug probe, by probe-rs",
            Self::Dfu => "the boot loader in ROM over USB, by dfu-util",
            Self::Uart => "the boot loader in ROM at USART1 or USART3, by stm32flash",
        }
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

/// The ways whose programs are installed: of all, or of one.
#[must_use]
pub fn installed(only: Option<Way>) -> Vec<Way> {
    let chosen = |way: &Way| only.is_none_or(|only| only == *way);
    Way::ALL.into_iter().filter(chosen).filter(|way| find_program(way.program()).is_ok()).collect()
}

/// Whether a drive that enters its boot loader by request can be written then: a program has to reach the loader. `uart` needs a
/// terminal at the loader's own pins; those of the drive are others.
#[must_use]
pub fn reaches_loader(only: Option<Way>, has_loader_port: bool) -> bool {
    installed(only).into_iter().any(|way| match way {
        Way::Probe => false,
        Way::Dfu => true,
        Way::Uart => has_loader_port,
    })
}

/// The programs of all ways, for messages.
#[must_use]
pub fn programs() -> String {
    Way::ALL.map(Way::program).join(", ")
}
