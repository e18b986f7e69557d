//! The identity of the USB adapter behind a serial port, from sysfs.
//!
//! The kernel gives a name like `/dev/ttyUSB0` to the adapter that comes first, so after a reconnect the name may belong to
//! another one. The serial number identifies an adapter; one without a number is identified by its place on the bus.

use std::fmt;
use std::fs;
use std::path::Path;

/// The terminals in sysfs.
const TERMINALS: &str = "/sys/class/tty";

/// A USB adapter, or the USB port of a board.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UsbAdapter {
    /// Vendor number.
    pub vendor: u16,
    /// Product number.
    pub product: u16,
    /// What distinguishes it from others of its kind.
    pub unit: Unit,
}

/// What distinguishes an adapter from others of its kind.
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
    fn a_serial_number_distinguishes_an_adapter_and_otherwise_its_place() {
        let at = |place, serial| adapter(place, serial).to_string();
        assert_eq!(at("1-2", Some("A50285BI")), "USB 0403:6001 with serial number A50285BI");
        assert_eq!(at("1-2", None), "USB 0403:6001 at bus position 1-2, without a serial number");
        assert_eq!(adapter("1-2", Some("A")), adapter("1-4.1", Some("A")));
    }

    #[test]
    fn a_terminal_that_is_not_on_usb_has_no_adapter() {
        let root = tempfile::tempdir().unwrap();
        fs::create_dir_all(root.path().join("ttyS0/device")).unwrap();
        assert_eq!(UsbAdapter::in_folder(root.path(), Path::new("/dev/ttyS0")), None);
        assert_eq!(UsbAdapter::in_folder(root.path(), Path::new("/dev/ttyS1")), None);
    }
}
