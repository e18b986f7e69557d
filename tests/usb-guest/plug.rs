//! Drives on the virtual host controller, each until its process is killed.

use std::time::Instant;

use anyhow::{Result, anyhow};
use lashloop_firmware::usb::{Identification, UsbLine};
use tests::usb::bus::Bus;
use tests::usb::ft232r::Ft232r;
use tests::usb::vhci::{Plug, Request};
use usb_device::bus::UsbBusAllocator;

use crate::drive::Powered;

/// A drive with the USB port of the firmware.
pub(crate) fn cdc(port: u32, serial_number: &str) -> Result<()> {
    let bus = Bus::default();
    let allocator = UsbBusAllocator::new(bus.clone());
    let identification = Identification::of_bench_drive(serial_number);
    let mut line = UsbLine::new(&allocator, identification).map_err(|error| anyhow!("{error:?}"))?;
    let mut board = Powered::new("usb-twin");
    let mut plug = Plug::insert(port)?;
    loop {
        for request in plug.requests(board.until_tick())? {
            match request {
                Request::Submit(urb) => bus.submit(urb),
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
}

/// A drive behind a serial adapter.
pub(crate) fn ftdi(port: u32, serial_number: &str) -> Result<()> {
    let mut chip = Ft232r::new(serial_number, Instant::now());
    let mut board = Powered::new("uart-twin");
    let mut plug = Plug::insert(port)?;
    loop {
        let event = chip.next_event().map(|at| at.saturating_duration_since(Instant::now()));
        let limit = [event, board.until_tick()].into_iter().flatten().min();
        for request in plug.requests(limit)? {
            match request {
                Request::Submit(urb) => chip.submit(&urb, Instant::now()),
                Request::Unlink { number, transfer } => plug.unlinked(number, chip.unlink(transfer))?,
            }
        }
        board.tick();
        let now = Instant::now();
        let received = chip.take_for_drive(now);
        chip.send_to_host(&board.exchange(&received), now);
        for completion in chip.completed(now) {
            plug.complete(&completion)?;
        }
    }
}
