//! The program of the Linux guest: its first process, and the devices on its virtual host controller.
//!
//! ```text
//! /init                             as the first process: mounts, drivers, udev, then the agent of the tests
//! /init plug cdc|ftdi PORT SERIAL   a drive that is plugged in until the process is killed
//! ```

mod agent;
mod boot;
mod drive;
mod plug;

use std::process::ExitCode;

use anyhow::{Result, bail};

fn main() -> ExitCode {
    let words: Vec<_> = std::env::args().skip(1).collect();
    let words: Vec<_> = words.iter().map(String::as_str).collect();
    match run(&words) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("usb-guest: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run(words: &[&str]) -> Result<()> {
    match words {
        // The kernel passes words of its command line that it doesn't know.
        _ if std::process::id() == 1 => {
            let result = boot::boot().and_then(|()| agent::serve());
            if let Err(error) = &result {
                eprintln!("usb-guest: {error:#}");
            }
            boot::power_off()?;
            result
        }
        ["plug", "cdc", port, serial_number] => plug::cdc(port.parse()?, serial_number),
        ["plug", "ftdi", port, serial_number] => plug::ftdi(port.parse()?, serial_number),
        _ => bail!("as the first process of a guest, or: plug cdc|ftdi PORT SERIAL"),
    }
}
