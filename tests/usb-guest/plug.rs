//! Devices on the virtual host controller, each until its cable is pulled or its process is killed.

use std::time::{Duration, Instant};

use anyhow::{Result, anyhow};
use lashloop_firmware::drive::Drive;
use lashloop_firmware::usb::{Identification, UsbLine};
use tests::powered::Powered;
use tests::rom_loader::{Defect, RomLoader};
use tests::usb::bus::Bus;
use tests::usb::ft232r::Ft232r;
use tests::usb::vhci::{Plug, Request};
use usb_device::bus::UsbBusAllocator;

use crate::cable::Cable;

/// A drive with the USB port of the firmware.
pub(crate) fn cdc(port: u32, serial_number: &str, mut cable: Cable) -> Result<()> {
    let bus = Bus::default();
    let allocator = UsbBusAllocator::new(bus.clone());
    let identification = Identification::of_bench_drive(serial_number);
    let mut line = UsbLine::new(&allocator, identification).map_err(|error| anyhow!("{error:?}"))?;
    let mut board = Powered::from(Drive::new("usb-twin"));
    // The reset of the plug, before a request that it would drop: the kernel waits 5 s for that one.
    line.poll();
    let mut plug = Plug::insert(port)?;
    while cable.time_left() != Some(Duration::ZERO) {
        for request in plug.requests(earliest([board.until_tick(), cable.time_left()]))? {
            match request {
                Request::Submit(urb) => {
                    cable.carry(&urb);
                    bus.submit(urb);
                }
                Request::Unlink { number, transfer } => plug.unlinked(number, bus.unlink(transfer))?,
            }
        }
        board.tick();
        loop {
            line.poll();
            while line.receive(&mut board.drive, &board.clock) | line.transmit(&mut board.drive) {}
            for completion in bus.completed() {
                plug.complete(&completion)?;
            }
            if !bus.is_interrupting() {
                break;
            }
        }
    }
    Ok(())
}

/// What a serial adapter leads to.
pub(crate) enum FarEnd {
    Drive(Box<Powered>),
    Loader(RomLoader),
}

impl FarEnd {
    pub(crate) fn drive() -> Self {
        Self::Drive(Box::new(Drive::new("uart-twin").into()))
    }

    pub(crate) fn loader() -> Self {
        Self::Loader(RomLoader::new(Defect::None))
    }

    fn until_tick(&self) -> Option<Duration> {
        match self {
            Self::Drive(board) => board.until_tick(),
            Self::Loader(_) => None,
        }
    }

    fn exchange(&mut self, bytes: &[u8]) -> Vec<u8> {
        match self {
            Self::Drive(board) => {
                board.tick();
                board.exchange(bytes)
            }
            Self::Loader(loader) => loader.exchange(bytes),
        }
    }

    fn has_left_loader(&self) -> bool {
        matches!(self, Self::Loader(RomLoader { left_for: Some(_), .. }))
    }
}

/// A serial adapter. Its cable is also pulled when a loader starts what it has received.
pub(crate) fn ftdi(port: u32, serial_number: &str, mut cable: Cable, mut far_end: FarEnd) -> Result<()> {
    let mut chip = Ft232r::new(serial_number, Instant::now());
    let mut plug = Plug::insert(port)?;
    while cable.time_left() != Some(Duration::ZERO) {
        let event = chip.next_event().map(|at| at.saturating_duration_since(Instant::now()));
        for request in plug.requests(earliest([event, far_end.until_tick(), cable.time_left()]))? {
            match request {
                Request::Submit(urb) => {
                    cable.carry(&urb);
                    chip.submit(&urb, Instant::now());
                }
                Request::Unlink { number, transfer } => plug.unlinked(number, chip.unlink(transfer))?,
            }
        }
        let now = Instant::now();
        let received = chip.take_for_drive(now);
        chip.send_to_host(&far_end.exchange(&received), now);
        for completion in chip.completed(now) {
            plug.complete(&completion)?;
        }
        if far_end.has_left_loader() {
            cable.pull();
        }
    }
    Ok(())
}

fn earliest<const N: usize>(times: [Option<Duration>; N]) -> Option<Duration> {
    times.into_iter().flatten().min()
}
