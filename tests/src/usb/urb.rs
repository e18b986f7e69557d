//! A transfer that a host requests from a device, after USB/IP's name for it: USB request block.

use usb_device::UsbDirection;

/// A requested transfer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Urb {
    /// Number that the completion refers to.
    pub number: u32,
    /// Number of the endpoint; 0 is the control endpoint.
    pub endpoint: u8,
    /// Direction of the data, seen from the host.
    pub direction: UsbDirection,
    /// Bytes that the host sends, or takes at most.
    pub length: usize,
    /// The request of a control transfer.
    pub setup: [u8; 8],
    /// Bytes that the host sends.
    pub data: Vec<u8>,
}

/// The end of a transfer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Completion {
    /// Number of the transfer.
    pub number: u32,
    /// Why it failed, if it did.
    pub error: Option<TransferError>,
    /// Bytes transferred.
    pub length: usize,
    /// Bytes for the host.
    pub data: Vec<u8>,
}

/// Why a transfer failed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TransferError {
    /// The endpoint is stalled: the device rejects the request.
    Stalled,
}

impl Completion {
    /// The end of a transfer to the device.
    #[must_use]
    pub fn taken(number: u32, length: usize) -> Self {
        Self { number, error: None, length, data: Vec::new() }
    }

    /// The end of a transfer from the device.
    #[must_use]
    pub fn given(number: u32, data: Vec<u8>) -> Self {
        Self { number, error: None, length: data.len(), data }
    }

    /// The end of a rejected transfer.
    #[must_use]
    pub fn stalled(number: u32) -> Self {
        Self { number, error: Some(TransferError::Stalled), length: 0, data: Vec::new() }
    }
}
