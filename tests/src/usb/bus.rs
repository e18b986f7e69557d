//! A bus for `usb-device` whose far end is a queue of requested transfers.
//!
//! Packets wait as on a wire: the bus rejects what the device has not read (NAK), and a packet of the device stays in its
//! endpoint until the host requests it. A transfer from the device ends with a short packet or when it is full.

mod control;
mod endpoints;

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use usb_device::bus::PollResult;
use usb_device::endpoint::{EndpointAddress, EndpointType};
use usb_device::{Result, UsbDirection, UsbError};

use super::urb::{Completion, Urb};
use control::Control;
use endpoints::{Endpoints, MAX_ENDPOINTS};

/// A bus. Clones are handles of the same bus: one for the device, one for the host's side.
#[derive(Clone)]
pub struct Bus(Arc<Mutex<Wires>>);

/// An event that isn't a transfer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BusEvent {
    /// The host has plugged in or reset the device.
    Reset,
    /// The host has suspended the bus.
    Suspend,
    /// The host has resumed the bus.
    Resume,
}

#[derive(Default)]
struct Wires {
    event: Option<BusEvent>,
    control: Control,
    endpoints: Endpoints,
    completed: Vec<Completion>,
}

impl Default for Bus {
    /// A bus with a device that was just plugged in.
    fn default() -> Self {
        Self(Arc::new(Mutex::new(Wires { event: Some(BusEvent::Reset), ..Wires::default() })))
    }
}

impl Bus {
    fn wires(&self) -> MutexGuard<'_, Wires> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Signals an event to the device.
    pub fn signal(&self, event: BusEvent) {
        self.wires().event = Some(event);
    }

    /// Requests a transfer.
    pub fn submit(&self, urb: Urb) {
        let Wires { control, endpoints, completed, .. } = &mut *self.wires();
        if urb.endpoint == 0 { control.submit(urb) } else { completed.extend(endpoints.submit(urb)) }
    }

    /// Takes a transfer back; returns whether it was still pending.
    pub fn unlink(&self, number: u32) -> bool {
        let Wires { control, endpoints, .. } = &mut *self.wires();
        control.unlink(number) || endpoints.unlink(number)
    }

    /// The transfers that have ended since the last call.
    #[must_use]
    pub fn completed(&self) -> Vec<Completion> {
        std::mem::take(&mut self.wires().completed)
    }

    /// Whether the device has an event to poll for. A packet that it leaves unread is none.
    #[must_use]
    pub fn is_interrupting(&self) -> bool {
        let wires = self.wires();
        wires.event.is_some() || wires.control.is_interrupting() || wires.endpoints.is_interrupting()
    }
}

impl usb_device::bus::UsbBus for Bus {
    fn alloc_ep(
        &mut self,
        direction: UsbDirection,
        address: Option<EndpointAddress>,
        _: EndpointType,
        max_packet: u16,
        _: u8,
    ) -> Result<EndpointAddress> {
        match address {
            Some(address) if address.index() == 0 => Ok(address),
            _ => self.wires().endpoints.allocate(direction, address, max_packet),
        }
    }

    fn enable(&mut self) {}

    fn reset(&self) {
        let mut wires = self.wires();
        wires.endpoints.reset();
        wires.control.reset();
    }

    fn set_device_address(&self, _: u8) {}

    fn write(&self, address: EndpointAddress, packet: &[u8]) -> Result<usize> {
        let Wires { control, endpoints, completed, .. } = &mut *self.wires();
        match address.index() {
            0 => completed.extend(control.write(packet)),
            index => completed.extend(endpoints.write(index, packet)?),
        }
        Ok(packet.len())
    }

    fn read(&self, address: EndpointAddress, buffer: &mut [u8]) -> Result<usize> {
        let Wires { control, endpoints, completed, .. } = &mut *self.wires();
        let packet = match address.index() {
            0 => control.read()?,
            index => {
                let (packet, completion) = endpoints.read(index)?;
                completed.extend(completion);
                packet
            }
        };
        buffer.get_mut(..packet.len()).ok_or(UsbError::BufferOverflow)?.copy_from_slice(&packet);
        Ok(packet.len())
    }

    fn set_stalled(&self, address: EndpointAddress, stalled: bool) {
        let Wires { control, endpoints, completed, .. } = &mut *self.wires();
        match address.index() {
            0 if stalled => completed.extend(control.stall()),
            0 => {}
            index => endpoints.set_stalled(index, address.direction(), stalled),
        }
    }

    fn is_stalled(&self, address: EndpointAddress) -> bool {
        address.index() != 0 && self.wires().endpoints.is_stalled(address.index(), address.direction())
    }

    fn suspend(&self) {}

    fn resume(&self) {}

    fn poll(&self) -> PollResult {
        let wires = &mut *self.wires();
        match wires.event.take() {
            Some(BusEvent::Reset) => return PollResult::Reset,
            Some(BusEvent::Suspend) => return PollResult::Suspend,
            Some(BusEvent::Resume) => return PollResult::Resume,
            None => {}
        }
        let [mut ep_out, mut ep_in_complete, mut ep_setup] = [0; 3];
        wires.control.events(&mut ep_out, &mut ep_in_complete, &mut ep_setup);
        for index in 1..MAX_ENDPOINTS {
            ep_out |= u16::from(wires.endpoints.has_packet(index)) << index;
            ep_in_complete |= u16::from(wires.endpoints.take_sent(index)) << index;
        }
        if ep_out | ep_in_complete | ep_setup == 0 {
            PollResult::None
        } else {
            PollResult::Data { ep_out, ep_in_complete, ep_setup }
        }
    }
}
