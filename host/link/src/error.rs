//! Why a link fails.

use std::io;
use std::time::Duration;

use super::usb_adapter::UsbAdapter;

/// A write that takes longer goes to a line that takes no bytes any more.
pub(super) const WRITE_LIMIT: Duration = Duration::from_secs(1);

/// A write takes longer only to a far end that reads byte by byte, with pauses.
pub(super) const WHOLE_WRITE_LIMIT: Duration = Duration::from_secs(4);

/// `EIO`, `ENXIO` and `ENODEV`: the far end of a terminal is closed or unplugged.
const DISCONNECTED: [i32; 3] = [5, 6, 19];

/// Why a link fails.
#[derive(Debug, thiserror::Error)]
pub enum LinkError {
    /// The far end is disconnected: unplugged, closed or killed.
    #[error("the far end closed the line")]
    Disconnected,
    /// The line took no byte for as long as a write may take, or too few.
    #[error("the line took no bytes for {} s: the drive does not read", WRITE_LIMIT.as_secs())]
    Stuck,
    /// The adapter was unplugged, and its name now is that of another one.
    #[error(
        "another adapter has taken the name: expected {expected}, found {found}; plug in the former one, and name it by its \
         path under /dev/serial/by-id, which `lashloop doctor` lists"
    )]
    OtherAdapter {
        /// The adapter that the link was opened on.
        expected: Box<UsbAdapter>,
        /// The one that has its name now.
        found: Box<UsbAdapter>,
    },
    /// The operating system refused.
    #[error("{0}")]
    Io(io::Error),
}

impl From<io::Error> for LinkError {
    fn from(error: io::Error) -> Self {
        use io::ErrorKind::{BrokenPipe, ConnectionReset, NotConnected, UnexpectedEof};
        let disconnected = error.raw_os_error().is_some_and(|code| DISCONNECTED.contains(&code));
        if disconnected || matches!(error.kind(), BrokenPipe | ConnectionReset | NotConnected | UnexpectedEof)
        {
            Self::Disconnected
        } else {
            Self::Io(error)
        }
    }
}

impl From<rustix::io::Errno> for LinkError {
    fn from(error: rustix::io::Errno) -> Self {
        io::Error::from(error).into()
    }
}
