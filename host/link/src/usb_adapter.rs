//! The identity of the USB adapter behind a serial port, from sysfs.
//!
//! The kernel gives a name like `/dev/ttyUSB0` to the adapter that comes first, so after a reconnect the name may belong to
//! another one. The serial number identifies an adapter; one without a number is identified by its place on the bus.

use std::fmt;
use std::fs;
use std::path::Path;

use super::LinkError;

/// The terminals in sysfs.
const TERMINALS: &str = "/sys/class/tty";

/// A USB adapter, or the USB port of a board.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UsbAdapter {
    /// Vendor number.
    pub vendor: u16,
    /// Product number.
    pub product: u16,
    /// What tells it from others of its kind.
    pub unit: Unit,
}

/// What tells an adapter from others of its kind.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Unit {
    /// Its serial number.
    SerialNumber(String),
    /// Bus and sockets that it is plugged into, such as `1-2.4`, for an adapter without a serial number.
    Place(String),
}

impl UsbAdapter {
    /// The adapter of a terminal; `None` for a terminal that is not on USB, or on a system without sysfs.
    #[must_use]
    pub fn at(terminal: &Path) -> Option<Self> {
        Self::in_folder(Path::new(TERMINALS), terminal)
    }

    fn in_folder(terminals: &Path, terminal: &Path) -> Option<Self> {
        let interface = terminals.join(terminal.file_name()?).join("device").canonicalize().ok()?;
        // The port and the interface are folders inside that of the device.
        let device = interface.ancestors().find(|folder| folder.join("idVendor").is_file())?;
        let read = |name| Some(fs::read_to_string(device.join(name)).ok()?.trim().to_owned());
        let number = |name| u16::from_str_radix(&read(name)?, 16).ok();
        let unit = match read("serial").filter(|text| !text.is_empty()) {
            Some(serial_number) => Unit::SerialNumber(serial_number),
            None => Unit::Place(device.file_name()?.to_str()?.to_owned()),
        };
        Some(Self { vendor: number("idVendor")?, product: number("idProduct")?, unit })
    }

    /// Checks that a terminal has the adapter that it had when it was opened `first`, and returns that one.
    ///
    /// # Errors
    /// [`LinkError::OtherAdapter`] for another one, [`LinkError::Disconnected`] for none.
    pub fn same_as(first: Option<&Self>, found: Option<Self>) -> Result<Option<Self>, LinkError> {
        match (first, found) {
            (None, found) => Ok(found),
            (Some(_), None) => Err(LinkError::Disconnected),
            (Some(expected), Some(found)) if *expected != found => {
                Err(LinkError::OtherAdapter { expected: Box::new(expected.clone()), found: Box::new(found) })
            }
            (Some(_), found) => Ok(found),
        }
    }
}

impl fmt::Display for UsbAdapter {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "USB {:04x}:{:04x} ", self.vendor, self.product)?;
        match &self.unit {
            Unit::SerialNumber(number) => write!(out, "with serial number {number}"),
            Unit::Place(place) => write!(out, "at bus position {place}, without a serial number"),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::os::unix::fs::symlink;

    use super::*;

    /// sysfs with one terminal on an adapter: as of `ftdi_sio`, a port inside an interface inside the device.
    fn with_adapter(terminal: &str, place: &str, serial: Option<&str>) -> tempfile::TempDir {
        let root = tempfile::tempdir().unwrap();
        let device = root.path().join("devices").join(place);
        let port = device.join(format!("{place}:1.0")).join(terminal);
        fs::create_dir_all(&port).unwrap();
        fs::write(device.join("idVendor"), "0403\n").unwrap();
        fs::write(device.join("idProduct"), "6001\n").unwrap();
        if let Some(serial) = serial {
            fs::write(device.join("serial"), format!("{serial}\n")).unwrap();
        }
        let folder = root.path().join(terminal);
        fs::create_dir(&folder).unwrap();
        symlink(port, folder.join("device")).unwrap();
        root
    }

    fn adapter(place: &str, serial: Option<&str>) -> UsbAdapter {
        let root = with_adapter("ttyUSB0", place, serial);
        UsbAdapter::in_folder(root.path(), Path::new("/dev/ttyUSB0")).expect("an adapter")
    }

    #[test]
    fn an_adapter_is_the_same_in_another_socket_by_its_serial_number() {
        let first = adapter("1-2", Some("A50285BI"));
        assert_eq!(first.to_string(), "USB 0403:6001 with serial number A50285BI");
        let moved = adapter("1-4.1", Some("A50285BI"));
        assert!(matches!(UsbAdapter::same_as(Some(&first), Some(moved)), Ok(Some(_))));
    }

    #[test]
    fn another_adapter_under_the_old_name_is_rejected() {
        let (first, other) = (adapter("1-2", Some("A50285BI")), adapter("1-2", Some("B1")));
        let error = UsbAdapter::same_as(Some(&first), Some(other)).expect_err("another serial number");
        assert!(matches!(error, LinkError::OtherAdapter { .. }), "{error:?}");
        let text = error.to_string();
        assert!(
            text.contains("A50285BI") && text.contains("B1") && text.contains("/dev/serial/by-id"),
            "{text}"
        );
    }

    #[test]
    fn adapters_without_serial_numbers_differ_by_their_place() {
        let (first, same, other) = (adapter("1-2", None), adapter("1-2", None), adapter("1-3", None));
        assert!(UsbAdapter::same_as(Some(&first), Some(same)).is_ok());
        assert!(UsbAdapter::same_as(Some(&first), Some(other)).is_err());
    }

    #[test]
    fn an_unplugged_adapter_is_disconnected_and_a_first_one_is_taken() {
        let first = adapter("1-2", Some("A"));
        assert!(matches!(UsbAdapter::same_as(Some(&first), None), Err(LinkError::Disconnected)));
        assert!(matches!(UsbAdapter::same_as(None, None), Ok(None)));
        assert_eq!(UsbAdapter::same_as(None, Some(first.clone())).unwrap(), Some(first));
    }

    #[test]
    fn a_terminal_that_is_not_on_usb_has_no_adapter() {
        let root = tempfile::tempdir().unwrap();
        fs::create_dir_all(root.path().join("ttyS0/device")).unwrap();
        assert_eq!(UsbAdapter::in_folder(root.path(), Path::new("/dev/ttyS0")), None);
        assert_eq!(UsbAdapter::in_folder(root.path(), Path::new("/dev/ttyS1")), None);
    }
}
