//! The serial ports of this machine and the USB identity of their adapters.

use std::fmt::Write;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use serialport::{SerialPortInfo, SerialPortType};

/// udev's names that stay with an adapter on any USB port of the machine.
const BY_ID: &str = "/dev/serial/by-id";

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Port {
    pub path: PathBuf,
    pub bus: SerialPortType,
    pub stable_names: Vec<PathBuf>,
}

/// The present ports, sorted by name.
///
/// # Errors
/// The system can't list them.
pub fn list() -> io::Result<Vec<Port>> {
    Ok(known(serialport::available_ports()?, &stable_names(Path::new(BY_ID))))
}

/// The ports on USB, by their stable names where they have one. Empty where the system can't list them.
#[must_use]
pub fn on_usb() -> Vec<PathBuf> {
    let ports = list().unwrap_or_default().into_iter();
    let on_usb = ports.filter(|port| matches!(port.bus, SerialPortType::UsbPort(_)));
    on_usb.map(|port| port.stable_names.into_iter().next().unwrap_or(port.path)).collect()
}

/// Pairs of a stable name and its target. Empty without udev or without ports, when the folder is missing.
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
        let bus = info.port_type;
        Port { path, bus, stable_names }
    };
    let mut ports: Vec<_> = found.into_iter().map(port).collect();
    ports.sort_by(|a, b| a.path.cmp(&b.path));
    ports
}

/// The ports as text.
#[must_use]
pub fn describe(ports: &[Port]) -> String {
    if ports.is_empty() {
        return "No serial port found. A board that is plugged in and not listed may have a cable without data wires, \
                or run its boot loader.\nWithout a board: `lashloop run SCENARIO` uses the native twin."
            .to_owned();
    }
    let mut text = String::new();
    for port in ports {
        // Writing to a string does not fail.
        let _ = match &port.bus {
            SerialPortType::UsbPort(usb) => {
                let number = usb.serial_number.as_ref().map(|number| format!("serial number {number}"));
                let words = [usb.manufacturer.clone(), usb.product.clone(), number];
                let words: Vec<_> = words.into_iter().flatten().filter(|word| !word.is_empty()).collect();
                let ids = format!("USB {:04x}:{:04x}", usb.vid, usb.pid);
                writeln!(text, "{:<16} {ids}  {}", port.path.display(), words.join(", "))
            }
            SerialPortType::PciPort => writeln!(text, "{:<16} PCI", port.path.display()),
            SerialPortType::BluetoothPort => writeln!(text, "{:<16} Bluetooth", port.path.display()),
            // Often a port on the mainboard.
            SerialPortType::Unknown => writeln!(text, "{:<16} not on USB", port.path.display()),
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
    use serialport::UsbPortInfo;

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
    fn machine_without_ports_gets_advice() {
        insta::assert_snapshot!(describe(&[]), @r"
        No serial port found. A board that is plugged in and not listed may have a cable without data wires, or run its boot loader.
        Without a board: `lashloop run SCENARIO` uses the native twin.
        ");
    }

    #[test]
    fn stable_names_resolve_to_the_port() {
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
