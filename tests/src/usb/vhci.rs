//! The connection to Linux's virtual host controller, module `vhci_hcd`: the headers of USB/IP on a socket that the kernel
//! holds the other end of. Neither a network nor the tool `usbip` takes part.

use std::fs;
use std::io::{self, Read, Write};
use std::os::fd::AsRawFd;
use std::os::unix::net::UnixStream;
use std::time::Duration;

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use usb_device::UsbDirection;

use super::urb::{Completion, TransferError, Urb};

/// Where a device is attached.
const ATTACH: &str = "/sys/devices/platform/vhci_hcd.0/attach";
/// Length of every header, in bytes.
const HEADER: usize = 48;
/// Speed of a device, as the kernel numbers it.
const FULL_SPEED: u32 = 2;

const SUBMIT: u32 = 1;
const UNLINK: u32 = 2;
const ANSWER_TO_SUBMIT: u32 = 3;
const ANSWER_TO_UNLINK: u32 = 4;

const EPIPE: i32 = -32;
const ECONNRESET: i32 = -104;

/// What the kernel requests.
#[derive(Debug, PartialEq, Eq)]
pub enum Request {
    /// A transfer.
    Submit(Urb),
    /// An earlier transfer back.
    Unlink {
        /// Number of this request.
        number: u32,
        /// Number of the transfer.
        transfer: u32,
    },
}

/// A device plugged into a port of the virtual controller. Dropping it unplugs the device.
pub struct Plug {
    socket: UnixStream,
    received: Vec<u8>,
}

impl Plug {
    /// Plugs a device of full speed into a port.
    ///
    /// # Errors
    /// The module is not loaded, or the port is occupied.
    pub fn insert(port: u32) -> io::Result<Self> {
        let (socket, kernel) = UnixStream::pair()?;
        // The second number is that of the device on a remote machine, and of no meaning here.
        fs::write(ATTACH, format!("{port} {} {} {FULL_SPEED}", kernel.as_raw_fd(), port + 1))?;
        Ok(Self::on(socket))
    }

    fn on(socket: UnixStream) -> Self {
        Self { socket, received: Vec::new() }
    }

    /// Waits for requests, at most for `limit` if there is one.
    ///
    /// # Errors
    /// [`io::ErrorKind::UnexpectedEof`] when the kernel has unplugged the device.
    pub fn requests(&mut self, limit: Option<Duration>) -> io::Result<Vec<Request>> {
        let limit = limit
            .map(|limit| Timespec { tv_sec: limit.as_secs() as i64, tv_nsec: limit.subsec_nanos().into() });
        match poll(&mut [PollFd::new(&self.socket, PollFlags::IN)], limit.as_ref()) {
            Ok(0) | Err(rustix::io::Errno::INTR) => return Ok(Vec::new()),
            Ok(_) => {}
            Err(error) => return Err(error.into()),
        }
        let mut piece = [0; 1 << 14];
        match self.socket.read(&mut piece)? {
            0 => return Err(io::ErrorKind::UnexpectedEof.into()),
            count => self.received.extend_from_slice(&piece[..count]),
        }
        let mut requests = Vec::new();
        while let Some((request, length)) = parse(&self.received)? {
            self.received.drain(..length);
            requests.push(request);
        }
        Ok(requests)
    }

    /// Sends the end of a transfer.
    ///
    /// # Errors
    /// The kernel has unplugged the device.
    pub fn complete(&mut self, completion: &Completion) -> io::Result<()> {
        let status = match completion.error {
            None => 0,
            Some(TransferError::Stalled) => EPIPE,
        };
        let mut answer = header(ANSWER_TO_SUBMIT, completion.number, status, completion.length);
        answer.extend_from_slice(&completion.data);
        self.socket.write_all(&answer)
    }

    /// Answers a request for a transfer back: whether it was still pending.
    ///
    /// # Errors
    /// The kernel has unplugged the device.
    pub fn unlinked(&mut self, number: u32, was_pending: bool) -> io::Result<()> {
        let status = if was_pending { ECONNRESET } else { 0 };
        self.socket.write_all(&header(ANSWER_TO_UNLINK, number, status, 0))
    }
}

/// The header of an answer: command, number, three words that only requests use, status, length, and zeros.
fn header(command: u32, number: u32, status: i32, length: usize) -> Vec<u8> {
    let words = [command, number, 0, 0, 0, status as u32, length as u32, 0, 0, 0, 0, 0];
    words.into_iter().flat_map(u32::to_be_bytes).collect()
}

/// The first request and its length; `None` if it is incomplete.
fn parse(bytes: &[u8]) -> io::Result<Option<(Request, usize)>> {
    let Some(header) = bytes.get(..HEADER) else { return Ok(None) };
    let mut words =
        header.chunks_exact(4).map(|word| u32::from_be_bytes([word[0], word[1], word[2], word[3]]));
    let mut word = || words.next().unwrap_or_default();
    let [command, number, _, to_host, endpoint, flags_or_transfer, length] = [(); 7].map(|()| word());
    match command {
        SUBMIT => {
            let direction = if to_host == 1 { UsbDirection::In } else { UsbDirection::Out };
            let length = length as usize;
            let sent = if direction == UsbDirection::Out { length } else { 0 };
            let Some(data) = bytes.get(HEADER..HEADER + sent) else { return Ok(None) };
            let mut setup = [0; 8];
            setup.copy_from_slice(&header[HEADER - 8..]);
            let endpoint = endpoint as u8;
            let urb = Urb { number, endpoint, direction, length, setup, data: data.to_vec() };
            Ok(Some((Request::Submit(urb), HEADER + sent)))
        }
        UNLINK => Ok(Some((Request::Unlink { number, transfer: flags_or_transfer }, HEADER))),
        other => Err(io::Error::other(format!("USB/IP has no request {other}"))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn request(words: [u32; 10], tail: &[u8]) -> Vec<u8> {
        words.into_iter().flat_map(u32::to_be_bytes).chain(tail.iter().copied()).collect()
    }

    #[test]
    fn requests_are_read_from_pieces_of_a_stream() {
        let (ours, mut kernel) = UnixStream::pair().unwrap();
        let mut plug = Plug::on(ours);
        let setup = [0x21, 0x22, 3, 0, 0, 0, 0, 0];
        let submit = request([1, 7, 9, 0, 2, 0, 3, 0, 0, 0], &[&setup[..], b"abc"].concat());
        let unlink = request([2, 8, 9, 0, 0, 7, 0, 0, 0, 0], &[0; 8]);
        kernel.write_all(&submit[..50]).unwrap();
        assert_eq!(plug.requests(None).unwrap(), [], "the data are missing");
        kernel.write_all(&[&submit[50..], &unlink].concat()).unwrap();
        let urb = Urb {
            number: 7,
            endpoint: 2,
            direction: UsbDirection::Out,
            length: 3,
            setup,
            data: b"abc".into(),
        };
        let want = [Request::Submit(urb), Request::Unlink { number: 8, transfer: 7 }];
        assert_eq!(plug.requests(None).unwrap(), want);
        drop(kernel);
        let end = plug.requests(None).expect_err("unplugged");
        assert_eq!(end.kind(), io::ErrorKind::UnexpectedEof);
    }
}
