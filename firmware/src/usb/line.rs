//! The drive's bytes in USB packets.
//!
//! | situation | what the line does |
//! |---|---|
//! | a packet of 64 bytes ends the output | sends a zero-length packet: until a short packet the host holds the transfer back |
//! | a packet of 64 bytes arrives, the drive has no space for answers | keeps the packet; the bus rejects further ones (NAK) |
//! | DTR is off: no program has the port open | discards output, or the next program would start with old frames |
//! | the bus is suspended | discards output: the host reads nothing until it resumes |
//! | reset, unplugged | discards output and received bytes |
//!
//! Bytes that arrive shortly before DTR goes off are served: a host may send `Stop` and close the port at once. One packet
//! may stay in the hardware over a closed port; the first delimiter of the next host ends it.

use usb_device::UsbError;
use usb_device::bus::{UsbBus, UsbBusAllocator};
use usb_device::descriptor::lang_id::LangID;
use usb_device::device::{StringDescriptors, UsbDevice, UsbDeviceBuilder, UsbDeviceState, UsbVidPid};
use usb_device::prelude::BuilderError;
use usbd_serial::{CdcAcmClass, USB_CLASS_CDC};

use lashloop_protocol::frame::DELIMITER;

use crate::drive::{Clock, Drive};
use crate::law::LawSet;

/// Bytes of the largest packet of a bulk endpoint at full speed (USB 2.0, 5.8.3).
pub const PACKET_BYTES: usize = 64;

/// What a host sees of the port before a drive answers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Identification<'a> {
    /// Vendor number.
    pub vendor: u16,
    /// Product number.
    pub product_number: u16,
    /// Name of the product.
    pub product: &'a str,
    /// Number that differs from drive to drive. Hosts name ports by it.
    pub serial_number: &'a str,
}

impl<'a> Identification<'a> {
    /// A drive on the numbers that pid.codes reserves for tests (1209:0001). They are for one's own bench; a product needs
    /// numbers of its own.
    #[must_use]
    pub fn of_bench_drive(serial_number: &'a str) -> Self {
        Self { vendor: 0x1209, product_number: 0x0001, product: "Lashloop drive", serial_number }
    }
}

/// The state in which the host leaves the port.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HostSide {
    /// Unplugged, or not yet configured.
    Detached,
    /// The host has suspended the bus.
    Suspended,
    /// Configured, DTR off: no program has the port open.
    Closed,
    /// A program has the port open.
    Open,
}

/// Whether the host still holds back the bytes of the last transfer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Transfer {
    /// Its last packet was short.
    Ended,
    /// Its last packet was full.
    Pending,
}

/// The USB port of a drive.
pub struct UsbLine<'bus, B: UsbBus> {
    device: UsbDevice<'bus, B>,
    class: CdcAcmClass<'bus, B>,
    /// A packet from the host, and how many of its bytes the drive has taken.
    packet: heapless::Vec<u8, PACKET_BYTES>,
    taken: usize,
    /// Bytes of the drive's output that were sent since it was cleared.
    sent: usize,
    transfer: Transfer,
    /// A delimiter goes ahead of the output: it ends a frame that was cut when the drive turned to another line.
    delimiter_due: bool,
}

impl<'bus, B: UsbBus> UsbLine<'bus, B> {
    /// A port on a bus.
    ///
    /// # Errors
    /// The device can't be described to the bus.
    ///
    /// # Panics
    /// The bus has too few endpoints: next to the control endpoint it takes two to the host and one from it.
    pub fn new(
        bus: &'bus UsbBusAllocator<B>,
        identification: Identification<'bus>,
    ) -> Result<Self, BuilderError> {
        let Identification { vendor, product_number, product, serial_number } = identification;
        let class = CdcAcmClass::new(bus, PACKET_BYTES as u16);
        let strings = StringDescriptors::new(LangID::EN_US)
            .manufacturer("Lashloop")
            .product(product)
            .serial_number(serial_number);
        let device = UsbDeviceBuilder::new(bus, UsbVidPid(vendor, product_number))
            .device_class(USB_CLASS_CDC)
            .strings(&[strings])?
            .max_packet_size_0(PACKET_BYTES as u8)?
            .build();
        let packet = heapless::Vec::new();
        Ok(Self { device, class, packet, taken: 0, sent: 0, transfer: Transfer::Ended, delimiter_due: false })
    }

    /// The state in which the host leaves the port.
    #[must_use]
    pub fn host_side(&self) -> HostSide {
        match (self.device.state(), self.class.dtr()) {
            (UsbDeviceState::Default | UsbDeviceState::Addressed, _) => HostSide::Detached,
            (UsbDeviceState::Suspend, _) => HostSide::Suspended,
            (UsbDeviceState::Configured, false) => HostSide::Closed,
            (UsbDeviceState::Configured, true) => HostSide::Open,
        }
    }

    /// Serves the events of the bus. Call this at every interrupt of the bus.
    pub fn poll(&mut self) -> HostSide {
        self.device.poll(&mut [&mut self.class]);
        let host = self.host_side();
        if host == HostSide::Detached {
            self.packet.clear();
            self.taken = 0;
        }
        if host != HostSide::Open {
            self.transfer = Transfer::Ended;
            self.delimiter_due = false;
        }
        host
    }

    /// Whether the host has sent bytes that the drive has not taken.
    #[must_use]
    pub fn has_received(&mut self) -> bool {
        if self.taken == self.packet.len() {
            self.fetch_packet();
        }
        self.taken < self.packet.len()
    }

    /// Discards the bytes that the host has sent: the drive serves another line.
    pub fn discard_received(&mut self) {
        while self.has_received() {
            self.taken = self.packet.len();
        }
    }

    /// Passes received bytes to the drive, at most to the end of one frame. Returns whether the drive has taken any.
    pub fn receive<L: LawSet>(&mut self, drive: &mut Drive<L>, clock: &impl Clock) -> bool {
        if !self.has_received() {
            return false;
        }
        let used = drive.receive(&self.packet[self.taken..], clock);
        self.taken += used;
        used > 0
    }

    /// Reads the next packet, if one has arrived. A zero-length packet holds no byte.
    fn fetch_packet(&mut self) {
        let mut bytes = [0; PACKET_BYTES];
        let count = self.class.read_packet(&mut bytes).unwrap_or(0);
        self.packet.clear();
        // At most a packet, which is the capacity.
        let _ = self.packet.extend_from_slice(&bytes[..count]);
        self.taken = 0;
    }

    /// Starts the output anew, after output of the drive went to another line.
    pub fn restart(&mut self) {
        self.sent = 0;
        self.delimiter_due = true;
    }

    /// Passes a packet of the drive's output to the bus. Returns whether the bus has taken it.
    pub fn transmit<L: LawSet>(&mut self, drive: &mut Drive<L>) -> bool {
        if self.host_side() != HostSide::Open {
            self.sent = 0;
            drive.clear_output();
            return false;
        }
        if self.delimiter_due {
            self.delimiter_due = self.class.write_packet(&[DELIMITER]).is_err();
            return !self.delimiter_due;
        }
        let rest = drive.output().get(self.sent..).unwrap_or_default();
        if rest.is_empty() && self.transfer == Transfer::Ended {
            return false;
        }
        let packet = &rest[..rest.len().min(PACKET_BYTES)];
        match self.class.write_packet(packet) {
            Ok(_) => {
                self.transfer =
                    if packet.len() == PACKET_BYTES { Transfer::Pending } else { Transfer::Ended };
                self.sent += packet.len();
                if self.sent == drive.output().len() {
                    self.sent = 0;
                    drive.clear_output();
                }
                true
            }
            // The bus has not sent the former packet yet, and its interrupt follows.
            Err(UsbError::WouldBlock) => false,
            // No other error is possible for a packet of this size on an endpoint that the bus gave. The bytes are lost as
            // on a line: the host repeats its request.
            Err(_) => {
                self.sent = 0;
                drive.clear_output();
                false
            }
        }
    }
}
