//! Options that name a drive and its line.

use clap::Args;
use lashloop_bench::device::DeviceChoice;

/// Speed of a serial port without a scenario, in bit/s.
pub(super) const DEFAULT_BAUD: u32 = 921_600;

#[derive(Args)]
pub(super) struct DeviceOption {
    /// Drive: inproc, native, qemu, qemu:ELF, or the path of a terminal; see `lashloop run --help`
    #[arg(long, global = true, default_value = "native", value_name = "DEVICE")]
    pub(super) device: DeviceChoice,
}

#[derive(Args)]
pub(super) struct BaudOption {
    /// Speed of a serial port, in bit/s
    #[arg(long, global = true, default_value_t = DEFAULT_BAUD, value_parser = clap::value_parser!(u32).range(1200..=12_000_000))]
    pub(super) baud: u32,
}
