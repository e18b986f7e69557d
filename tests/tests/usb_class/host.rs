//! A host on the bus: enumeration, port, bulk transfers.

use lashloop_firmware::drive::{Drive, ManualClock};
use lashloop_firmware::usb::{ByteLine, Identification, Lines, UsbLine};
use tests::usb::bus::{Bus, BusEvent};
use tests::usb::urb::{Completion, Urb};
use usb_device::UsbDirection;
use usb_device::bus::UsbBusAllocator;

/// The bulk endpoints, as the bus numbers them: the first to the host is the interrupt endpoint of the class.
const TO_DEVICE: u8 = 1;
const TO_HOST: u8 = 2;
const SET_CONFIGURATION: [u8; 8] = [0x00, 9, 1, 0, 0, 0, 0, 0];

/// What the drive is served by.
pub(crate) trait Port {
    fn poll(&mut self);
    /// Moves bytes until none moves.
    fn serve(&mut self, drive: &mut Drive, clock: &ManualClock);
}

impl Port for UsbLine<'static, Bus> {
    fn poll(&mut self) {
        self.poll();
    }

    fn serve(&mut self, drive: &mut Drive, clock: &ManualClock) {
        while self.receive(drive, clock) | self.transmit(drive) {}
    }
}

impl<U: ByteLine> Port for Lines<'static, U, Bus> {
    fn poll(&mut self) {
        self.poll();
    }

    fn serve(&mut self, drive: &mut Drive, clock: &ManualClock) {
        while self.exchange(drive, clock) {
            self.send();
        }
    }
}

/// A host of a drive with a USB port alone.
pub(crate) type UsbHost = Host<UsbLine<'static, Bus>>;

pub(crate) struct Host<P> {
    pub(crate) port: P,
    pub(crate) drive: Drive,
    pub(crate) clock: ManualClock,
    bus: Bus,
    submitted: u32,
    /// Transfers to the drive that have not ended.
    unread: Vec<u32>,
    completed: Vec<Completion>,
}

impl UsbHost {
    pub(crate) fn new() -> Self {
        Self::of(|line| line)
    }
}

impl<U: ByteLine> Host<Lines<'static, U, Bus>> {
    /// A host of a drive with a UART too.
    pub(crate) fn next_to(uart: U) -> Self {
        Self::of(|line| Lines::new(uart, Some(line)))
    }
}

impl<P: Port> Host<P> {
    fn of(port: impl FnOnce(UsbLine<'static, Bus>) -> P) -> Self {
        let bus = Bus::default();
        // A line borrows its bus for as long as the firmware runs.
        let allocator: &'static _ = Box::leak(Box::new(UsbBusAllocator::new(bus.clone())));
        let line = UsbLine::new(allocator, Identification::of_bench_drive("1")).expect("a port");
        Self {
            port: port(line),
            drive: Drive::new("test"),
            clock: ManualClock::default(),
            bus,
            submitted: 0,
            unread: Vec::new(),
            completed: Vec::new(),
        }
    }

    /// Enumerates the device and opens its port.
    pub(crate) fn open_port(&mut self) {
        self.serve();
        self.control(SET_CONFIGURATION, 0).expect("the configuration");
        self.set_dtr(true);
    }

    pub(crate) fn set_dtr(&mut self, on: bool) {
        let number = self.submit_dtr(on);
        self.serve();
        assert!(self.take(number).is_some(), "the class takes SetControlLineState");
    }

    pub(crate) fn submit_dtr(&mut self, on: bool) -> u32 {
        self.request(0, UsbDirection::Out, [0x21, 0x22, on.into(), 0, 0, 0, 0, 0], &[], 0)
    }

    /// A control transfer to its end; `None` if it is rejected.
    pub(crate) fn control(&mut self, setup: [u8; 8], length: usize) -> Option<Vec<u8>> {
        let direction = if setup[0] & 0x80 == 0 { UsbDirection::Out } else { UsbDirection::In };
        let number = self.request(0, direction, setup, &[], length);
        self.serve();
        let completion = self.take(number).expect("a control transfer ends");
        completion.error.is_none().then_some(completion.data)
    }

    /// Requests a transfer to the drive.
    pub(crate) fn submit(&mut self, bytes: &[u8]) {
        let number = self.request(TO_DEVICE, UsbDirection::Out, [0; 8], bytes, bytes.len());
        self.unread.push(number);
    }

    pub(crate) fn send(&mut self, bytes: &[u8]) {
        self.submit(bytes);
        self.serve();
    }

    /// Requests bytes of the drive; `None` if the transfer doesn't end, and is taken back.
    pub(crate) fn receive(&mut self, length: usize) -> Option<Vec<u8>> {
        let number = self.request(TO_HOST, UsbDirection::In, [0; 8], &[], length);
        self.serve();
        let completion = self.take(number);
        if completion.is_none() {
            assert!(self.bus.unlink(number), "a transfer that did not end is pending");
        }
        completion.map(|completion| completion.data)
    }

    /// Transfers that the drive has not taken.
    pub(crate) fn unread(&self) -> usize {
        self.unread.len()
    }

    pub(crate) fn signal(&mut self, event: BusEvent) {
        self.bus.signal(event);
        self.serve();
    }

    /// Serves the bus until it is quiet, as the interrupt of a board does.
    pub(crate) fn serve(&mut self) {
        loop {
            self.port.poll();
            self.port.serve(&mut self.drive, &self.clock);
            let completed = self.bus.completed();
            let is_quiet = completed.is_empty() && !self.bus.is_interrupting();
            self.completed.extend(completed);
            if is_quiet {
                break;
            }
        }
        self.completed.retain(|completion| {
            let before = self.unread.len();
            self.unread.retain(|number| *number != completion.number);
            self.unread.len() == before
        });
    }

    fn take(&mut self, number: u32) -> Option<Completion> {
        let at = self.completed.iter().position(|completion| completion.number == number)?;
        Some(self.completed.remove(at))
    }

    fn request(
        &mut self,
        endpoint: u8,
        direction: UsbDirection,
        setup: [u8; 8],
        data: &[u8],
        length: usize,
    ) -> u32 {
        self.submitted += 1;
        let number = self.submitted;
        let data = data.to_vec();
        self.bus.submit(Urb { number, endpoint, direction, length, setup, data });
        number
    }
}
