//! The serial ports of this machine, with who made what is plugged into them.

use std::fmt::Write;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use serialport::{SerialPortInfo, SerialPortType, UsbPortInfo};

/// Where udev keeps names that stay with an adapter, whatever port of the machine it is plugged into.
const BY_ID: &str = "/dev/serial/by-id";

/// A serial port.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Port {
    /// What to open.
    pub path: PathBuf,
    /// What it hangs on.
    pub bus: Bus,
    /// Names that stay with the adapter.
    pub stable_names: Vec<PathBuf>,
}

/// What a serial port hangs on.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Bus {
    /// USB, with what the device says of itself.
    Usb(UsbIdentity),
    /// A card in the machine.
    Pci,
    /// Bluetooth.
    Bluetooth,
    /// The system does not say: often a port on the mainboard.
    Unknown,
}

/// What a USB device says of itself; texts that it doesn't give are empty.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct UsbIdentity {
    /// Vendor.
    pub vendor_id: u16,
    /// Product of this vendor.
    pub product_id: u16,
    /// Name of the vendor.
    pub manufacturer: String,
    /// Name of the product.
    pub product: String,
    /// Serial number.
    pub serial_number: String,
}

/// The ports that are here now, in the order of their names.
///
/// # Errors
/// The system does not tell.
pub fn list() -> io::Result<Vec<Port>> {
    Ok(known(serialport::available_ports()?, &stable_names(Path::new(BY_ID))))
}

/// Pairs of a stable name and what it stands for. Without udev, or without ports, there is no such folder.
fn stable_names(folder: &Path) -> Vec<(PathBuf, PathBuf)> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    entries.filter_map(|entry| Some((entry.path(), entry.path().canonicalize().ok()?))).collect()
}

fn known(found: Vec<SerialPortInfo>, stable_names: &[(PathBuf, PathBuf)]) -> Vec<Port> {
    let port = |info: SerialPortInfo| {
        let path = PathBuf::from(info.port_name);
        let mut stable_names: Vec<_> =
            stable_names.iter().filter(|(_, target)| *target == path).map(|(name, _)| name.clone()).collect();
        stable_names.sort();
        let bus = match info.port_type {
            SerialPortType::UsbPort(usb) => Bus::Usb(usb.into()),
            SerialPortType::PciPort => Bus::Pci,
            SerialPortType::BluetoothPort => Bus::Bluetooth,
            SerialPortType::Unknown => Bus::Unknown,
        };
        Port { path, bus, stable_names }
    };
    let mut ports: Vec<_> = found.into_iter().map(port).collect();
    ports.sort_by(|a, b| a.path.cmp(&b.path));
    ports
}

impl From<UsbPortInfo> for UsbIdentity {
    fn from(usb: UsbPortInfo) -> Self {
        Self {
            vendor_id: usb.vid,
            product_id: usb.pid,
            manufacturer: usb.manufacturer.unwrap_or_default(),
            product: usb.product.unwrap_or_default(),
            serial_number: usb.serial_number.unwrap_or_default(),
        }
    }
}

/// The ports as text for people.
#[must_use]
pub fn describe(ports: &[Port]) -> String {
    if ports.is_empty() {
        return "No serial port here. A board that is plugged in and not listed may have a cable without data wires, \
                or wait in its boot loader.\nWithout a board: `lashloop run SCENARIO` uses the native twin."
            .to_owned();
    }
    let mut text = String::new();
    for port in ports {
        // Writing to a string does not fail.
        let _ = match &port.bus {
            Bus::Usb(usb) => {
                let UsbIdentity { vendor_id, product_id, manufacturer, product, serial_number } = usb;
                let number = if serial_number.is_empty() {
                    String::new()
                } else {
                    format!("serial number {serial_number}")
                };
                let words = [manufacturer.as_str(), product.as_str(), number.as_str()];
                let words: Vec<_> = words.into_iter().filter(|word| !word.is_empty()).collect();
                let ids = format!("USB {vendor_id:04x}:{product_id:04x}");
                writeln!(text, "{:<16} {ids}  {}", port.path.display(), words.join(", "))
            }
            Bus::Pci => writeln!(text, "{:<16} PCI", port.path.display()),
            Bus::Bluetooth => writeln!(text, "{:<16} Bluetooth", port.path.display()),
            Bus::Unknown => writeln!(text, "{:<16} not on USB", port.path.display()),
        };
        for name in &port.stable_names {
            let _ = writeln!(text, "{:<16} {}", "", name.display());
        }
    }
    text.truncate(text.trim_end().len());
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn usb(vid: u16, pid: u16, words: [Option<&str>; 3]) -> SerialPortType {
        let [manufacturer, product, serial_number] = words.map(|word| word.map(str::to_owned));
        SerialPortType::UsbPort(UsbPortInfo { vid, pid, serial_number, manufacturer, product })
    }

    fn info(port_name: &str, port_type: SerialPortType) -> SerialPortInfo {
        SerialPortInfo { port_name: port_name.to_owned(), port_type }
    }

    #[test]
    fn ports_are_listed_with_identity_and_stable_names() {
        let found = vec![
            info(
                "/dev/ttyUSB0",
                usb(0x0403, 0x6001, [Some("FTDI"), Some("FT232R USB UART"), Some("A50285BI")]),
            ),
            info("/dev/ttyS0", SerialPortType::Unknown),
            info("/dev/ttyACM0", usb(0x0483, 0x374b, [None, Some("STM32 STLink"), None])),
        ];
        let by_id = ["usb-FTDI_FT232R_USB_UART_A50285BI-if00-port0", "usb-other-if00"]
            .map(|name| Path::new(BY_ID).join(name));
        let [ftdi, other] = by_id;
        let stable_names = [(ftdi, "/dev/ttyUSB0".into()), (other, "/dev/ttyACM7".into())];
        insta::assert_snapshot!(describe(&known(found, &stable_names)), @r"
        /dev/ttyACM0     USB 0483:374b  STM32 STLink
        /dev/ttyS0       not on USB
        /dev/ttyUSB0     USB 0403:6001  FTDI, FT232R USB UART, serial number A50285BI
                         /dev/serial/by-id/usb-FTDI_FT232R_USB_UART_A50285BI-if00-port0
        ");
    }

    #[test]
    fn a_machine_without_ports_gets_advice() {
        insta::assert_snapshot!(describe(&[]), @r"
        No serial port here. A board that is plugged in and not listed may have a cable without data wires, or wait in its boot loader.
        Without a board: `lashloop run SCENARIO` uses the native twin.
        ");
    }

    #[test]
    fn stable_names_lead_to_the_port_itself() {
        let folder = tempfile::tempdir().unwrap();
        let port = folder.path().join("ttyUSB0");
        fs::write(&port, "").unwrap();
        std::os::unix::fs::symlink("ttyUSB0", folder.path().join("usb-FTDI")).unwrap();
        let names = stable_names(folder.path());
        let target = port.canonicalize().unwrap();
        assert!(names.contains(&(folder.path().join("usb-FTDI"), target)), "{names:?}");
        assert_eq!(stable_names(&folder.path().join("missing")), []);
    }
}
