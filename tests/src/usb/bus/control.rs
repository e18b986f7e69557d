//! The control endpoint: one transfer at a time, in stages.

use std::collections::VecDeque;

use usb_device::{Result, UsbDirection, UsbError};

use crate::usb::urb::{Completion, Urb};

/// Largest packet of the control endpoint.
const MAX_PACKET: usize = 64;

#[derive(Default)]
pub(super) struct Control {
    transfer: Option<Transfer>,
    waiting: VecDeque<Urb>,
    /// Packets for the device: data, or the empty one that confirms data of the device.
    packets: VecDeque<Vec<u8>>,
    has_sent: bool,
}

struct Transfer {
    urb: Urb,
    stage: Stage,
    /// Bytes of the device.
    data: Vec<u8>,
}

/// What comes next in a transfer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stage {
    /// The device reads the request.
    Setup,
    /// The device sends data.
    DataToHost,
    /// The device reads data.
    DataToDevice,
    /// The device confirms with an empty packet.
    Confirmation,
}

impl Control {
    pub(super) fn reset(&mut self) {
        *self = Self { waiting: std::mem::take(&mut self.waiting), ..Self::default() };
        self.begin_next();
    }

    pub(super) fn submit(&mut self, urb: Urb) {
        self.waiting.push_back(urb);
        self.begin_next();
    }

    fn begin_next(&mut self) {
        if self.transfer.is_none()
            && let Some(urb) = self.waiting.pop_front()
        {
            self.packets.clear();
            self.transfer = Some(Transfer { urb, stage: Stage::Setup, data: Vec::new() });
        }
    }

    fn end(&mut self) -> Option<Transfer> {
        let ended = self.transfer.take();
        self.begin_next();
        ended
    }

    pub(super) fn unlink(&mut self, number: u32) -> bool {
        if self.transfer.as_ref().is_some_and(|transfer| transfer.urb.number == number) {
            self.end();
            return true;
        }
        let before = self.waiting.len();
        self.waiting.retain(|urb| urb.number != number);
        self.waiting.len() != before
    }

    pub(super) fn stall(&mut self) -> Option<Completion> {
        // A device stalls the endpoint once for each direction.
        let is_begun = self.transfer.as_ref().is_some_and(|transfer| transfer.stage != Stage::Setup);
        let transfer = is_begun.then(|| self.end())??;
        Some(Completion::stalled(transfer.urb.number))
    }

    pub(super) fn read(&mut self) -> Result<Vec<u8>> {
        if let Some(packet) = self.packets.pop_front() {
            if let Some(transfer) = &mut self.transfer
                && transfer.stage == Stage::DataToDevice
                && self.packets.is_empty()
            {
                transfer.stage = Stage::Confirmation;
            }
            return Ok(packet);
        }
        let transfer = self.transfer.as_mut().filter(|transfer| transfer.stage == Stage::Setup);
        let transfer = transfer.ok_or(UsbError::WouldBlock)?;
        let Urb { direction, length, data, setup, .. } = &transfer.urb;
        transfer.stage = match direction {
            UsbDirection::In if *length > 0 => Stage::DataToHost,
            UsbDirection::Out if !data.is_empty() => {
                self.packets.extend(data.chunks(MAX_PACKET).map(<[u8]>::to_vec));
                Stage::DataToDevice
            }
            UsbDirection::In | UsbDirection::Out => Stage::Confirmation,
        };
        Ok(setup.to_vec())
    }

    pub(super) fn write(&mut self, packet: &[u8]) -> Option<Completion> {
        self.has_sent = true;
        let transfer = self.transfer.as_mut()?;
        match transfer.stage {
            Stage::DataToHost => {
                transfer.data.extend_from_slice(packet);
                let is_over = packet.len() < MAX_PACKET || transfer.data.len() >= transfer.urb.length;
                let transfer = is_over.then(|| self.end())??;
                // The host confirms.
                self.packets.push_back(Vec::new());
                Some(Completion::given(transfer.urb.number, transfer.data))
            }
            Stage::Confirmation => {
                let transfer = self.end()?;
                Some(Completion::taken(transfer.urb.number, transfer.urb.data.len()))
            }
            Stage::Setup | Stage::DataToDevice => None,
        }
    }

    fn has_setup(&self) -> bool {
        self.transfer.as_ref().is_some_and(|transfer| transfer.stage == Stage::Setup)
    }

    pub(super) fn is_interrupting(&self) -> bool {
        self.has_sent || !self.packets.is_empty() || self.has_setup()
    }

    /// Adds the events of this endpoint to those of the others, and takes them.
    pub(super) fn events(&mut self, out: &mut u16, in_complete: &mut u16, setup: &mut u16) {
        // The confirmation of a transfer is read before the request of the next.
        *out |= u16::from(!self.packets.is_empty());
        *setup |= u16::from(self.packets.is_empty() && self.has_setup());
        *in_complete |= u16::from(std::mem::take(&mut self.has_sent));
    }
}
