//! The program of the Linux guest: its first process, and the devices on its virtual host controller.
//!
//! ```text
//! /init                    as the first process: mounts, drivers, udev, then the agent of the tests
//! /init plug KIND PORT SERIAL [BYTES DELAY_US]
//!                          a device that is plugged in until the process is killed, or so long after the host has sent so much:
//!                          a drive by USB (`cdc`) or an adapter (`ftdi`), or a boot loader by an adapter (`loader`)
//! /init image PATH         an image for the boot loader
//! /init spin               load, until the process is killed
//! ```

mod agent;
mod boot;
mod cable;
mod plug;

use std::path::Path;
use std::process::ExitCode;

use anyhow::{Result, bail};
use cable::Cable;
use plug::FarEnd;
use tests::elf::Elf;

/// Some 80 blocks of a boot loader.
const IMAGE_BYTES: usize = 20_004;

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
        ["plug", kind, port, serial_number, cable @ ..] => {
            let (port, cable) = (port.parse()?, Cable::new(cable)?);
            match *kind {
                "cdc" => plug::cdc(port, serial_number, cable),
                "ftdi" => plug::ftdi(port, serial_number, cable, FarEnd::drive()),
                "loader" => plug::ftdi(port, serial_number, cable, FarEnd::loader()),
                _ => bail!("no device {kind}"),
            }
        }
        ["image", path] => {
            Elf::image(IMAGE_BYTES, 1, false).write(Path::new(path));
            Ok(())
        }
        // Not `spin_loop`: the emulator takes long for that instruction, and the guest's clock stands still meanwhile.
        ["spin"] => loop {
            std::hint::black_box(());
        },
        _ => bail!("as the first process of a guest, or: plug, image or spin"),
    }
}
