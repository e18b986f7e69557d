//! The bulk and interrupt endpoints of a device.

use std::collections::VecDeque;

use usb_device::endpoint::EndpointAddress;
use usb_device::{Result, UsbDirection, UsbError};

use crate::usb::urb::{Completion, Urb};

/// Endpoints of the bus in each direction, the control endpoint included.
pub(super) const MAX_ENDPOINTS: usize = 8;

#[derive(Default)]
pub(super) struct Endpoints {
    to_host: [Option<ToHost>; MAX_ENDPOINTS],
    to_device: [Option<ToDevice>; MAX_ENDPOINTS],
}

#[derive(Default)]
struct ToHost {
    max_packet: usize,
    stalled: bool,
    /// Written by the device, not yet requested by the host.
    packet: Option<Vec<u8>>,
    /// Whether a packet was sent since the device last polled.
    has_sent: bool,
    transfers: VecDeque<TransferToHost>,
}

struct TransferToHost {
    number: u32,
    length: usize,
    data: Vec<u8>,
}

#[derive(Default)]
struct ToDevice {
    max_packet: usize,
    stalled: bool,
    transfers: VecDeque<TransferToDevice>,
}

struct TransferToDevice {
    number: u32,
    length: usize,
    /// Not read yet by the device.
    packets: VecDeque<Vec<u8>>,
}

impl ToHost {
    /// Sends the packet if the host has requested it.
    fn send(&mut self) -> Option<Completion> {
        let transfer = self.transfers.front_mut()?;
        let packet = self.packet.take()?;
        self.has_sent = true;
        transfer.data.extend_from_slice(&packet);
        let is_over = packet.len() < self.max_packet || transfer.data.len() >= transfer.length;
        let over = is_over.then(|| self.transfers.pop_front())??;
        Some(Completion::given(over.number, over.data))
    }
}

impl Endpoints {
    pub(super) fn allocate(
        &mut self,
        direction: UsbDirection,
        address: Option<EndpointAddress>,
        max_packet: u16,
    ) -> Result<EndpointAddress> {
        let is_free = |index: &usize| match direction {
            UsbDirection::In => self.to_host[*index].is_none(),
            UsbDirection::Out => self.to_device[*index].is_none(),
        };
        let wanted = address.map_or(1..MAX_ENDPOINTS, |address| address.index()..address.index() + 1);
        let index = wanted.take_while(|index| *index < MAX_ENDPOINTS).find(is_free);
        let index = index.ok_or(UsbError::EndpointOverflow)?;
        let max_packet = max_packet.into();
        match direction {
            UsbDirection::In => self.to_host[index] = Some(ToHost { max_packet, ..ToHost::default() }),
            UsbDirection::Out => self.to_device[index] = Some(ToDevice { max_packet, ..ToDevice::default() }),
        }
        Ok(EndpointAddress::from_parts(index, direction))
    }

    /// Empties every endpoint: what waits in one does not survive a reset of the bus.
    pub(super) fn reset(&mut self) {
        for endpoint in self.to_host.iter_mut().flatten() {
            *endpoint = ToHost { max_packet: endpoint.max_packet, ..ToHost::default() };
        }
        for endpoint in self.to_device.iter_mut().flatten() {
            *endpoint = ToDevice { max_packet: endpoint.max_packet, ..ToDevice::default() };
        }
    }

    pub(super) fn submit(&mut self, urb: Urb) -> Option<Completion> {
        let Urb { number, endpoint, direction, length, data, .. } = urb;
        let index = usize::from(endpoint);
        match direction {
            UsbDirection::In => {
                let Some(Some(endpoint)) = self.to_host.get_mut(index) else {
                    return Some(Completion::stalled(number));
                };
                endpoint.transfers.push_back(TransferToHost { number, length, data: Vec::new() });
                endpoint.send()
            }
            UsbDirection::Out => {
                let Some(Some(endpoint)) = self.to_device.get_mut(index) else {
                    return Some(Completion::stalled(number));
                };
                let mut packets: VecDeque<_> = data.chunks(endpoint.max_packet).map(<[u8]>::to_vec).collect();
                if packets.is_empty() {
                    packets.push_back(Vec::new());
                }
                endpoint.transfers.push_back(TransferToDevice { number, length: data.len(), packets });
                None
            }
        }
    }

    pub(super) fn unlink(&mut self, number: u32) -> bool {
        let pending = |endpoints: &Self| {
            let to_host = endpoints.to_host.iter().flatten().map(|endpoint| endpoint.transfers.len());
            let to_device = endpoints.to_device.iter().flatten().map(|endpoint| endpoint.transfers.len());
            to_host.chain(to_device).sum::<usize>()
        };
        let before = pending(self);
        for endpoint in self.to_host.iter_mut().flatten() {
            endpoint.transfers.retain(|transfer| transfer.number != number);
        }
        for endpoint in self.to_device.iter_mut().flatten() {
            endpoint.transfers.retain(|transfer| transfer.number != number);
        }
        pending(self) != before
    }

    pub(super) fn write(&mut self, index: usize, packet: &[u8]) -> Result<Option<Completion>> {
        let endpoint =
            self.to_host.get_mut(index).and_then(Option::as_mut).ok_or(UsbError::InvalidEndpoint)?;
        if packet.len() > endpoint.max_packet {
            return Err(UsbError::BufferOverflow);
        }
        if endpoint.packet.is_some() {
            return Err(UsbError::WouldBlock);
        }
        endpoint.packet = Some(packet.to_vec());
        Ok(endpoint.send())
    }

    pub(super) fn read(&mut self, index: usize) -> Result<(Vec<u8>, Option<Completion>)> {
        let endpoint =
            self.to_device.get_mut(index).and_then(Option::as_mut).ok_or(UsbError::InvalidEndpoint)?;
        let transfer = endpoint.transfers.front_mut().ok_or(UsbError::WouldBlock)?;
        let packet = transfer.packets.pop_front().ok_or(UsbError::WouldBlock)?;
        let completion =
            transfer.packets.is_empty().then(|| Completion::taken(transfer.number, transfer.length));
        if completion.is_some() {
            endpoint.transfers.pop_front();
        }
        Ok((packet, completion))
    }

    pub(super) fn has_packet(&self, index: usize) -> bool {
        self.to_device[index].as_ref().is_some_and(|endpoint| !endpoint.transfers.is_empty())
    }

    pub(super) fn take_sent(&mut self, index: usize) -> bool {
        self.to_host[index].as_mut().is_some_and(|endpoint| std::mem::take(&mut endpoint.has_sent))
    }

    pub(super) fn is_interrupting(&self) -> bool {
        self.to_host.iter().flatten().any(|endpoint| endpoint.has_sent)
    }

    pub(super) fn set_stalled(&mut self, index: usize, direction: UsbDirection, stalled: bool) {
        match direction {
            UsbDirection::In => {
                if let Some(Some(endpoint)) = self.to_host.get_mut(index) {
                    endpoint.stalled = stalled;
                }
            }
            UsbDirection::Out => {
                if let Some(Some(endpoint)) = self.to_device.get_mut(index) {
                    endpoint.stalled = stalled;
                }
            }
        }
    }

    pub(super) fn is_stalled(&self, index: usize, direction: UsbDirection) -> bool {
        match direction {
            UsbDirection::In => self.to_host.get(index).and_then(Option::as_ref).is_some_and(|it| it.stalled),
            UsbDirection::Out => {
                self.to_device.get(index).and_then(Option::as_ref).is_some_and(|it| it.stalled)
            }
        }
    }
}
