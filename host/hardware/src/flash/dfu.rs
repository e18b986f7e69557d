//! The boot loader in ROM over USB, by dfu-util (ST AN3156).

use std::path::Path;
use std::time::Duration;
use std::{fs, io};

use super::error::FlashError;
use super::image::{FLASH, Image};
use super::program::Runner;
use lashloop::rig::way::Way;

/// USB identity of the boot loader of every STM32.
const DEVICE: &str = "0483:df11";
/// The alternate setting that is the internal flash.
const FLASH_SETTING: &str = "0";
const LOOK_LIMIT: Duration = Duration::from_secs(10);
/// Erasing a sector of 128 KiB takes up to 2 s.
const WRITE_LIMIT: Duration = Duration::from_secs(120);

/// Whether the way is there.
///
/// # Errors
/// What is missing, as a sentence.
pub(super) fn look(runner: &Runner<'_>) -> Result<(), String> {
    let output = runner.run(Way::Dfu, ["-l", "-d", DEVICE], LOOK_LIMIT).map_err(|error| error.to_string())?;
    let found = |line: &&str| {
        line.contains(&format!("[{DEVICE}]")) && line.contains(&format!("alt={FLASH_SETTING},"))
    };
    match output.lines().filter(found).count() {
        0 => Err("no chip on USB is in its boot loader: hold BOOT0 high during a reset, with the USB port of the chip connected"
            .to_owned()),
        1 => Ok(()),
        chips => Err(format!("{chips} chips on USB are in their boot loader: connect only the one to flash")),
    }
}

/// Writes the bytes, reads them back and starts the firmware. `folder` takes the files that dfu-util reads and writes.
pub(super) fn write(image: &Image, folder: &Path, runner: &Runner<'_>) -> Result<(), FlashError> {
    let way = Way::Dfu;
    let writing = |source| FlashError::Writing { way, source };
    let [source, copied] = ["image.bin", "flash.bin"].map(|name| folder.join(name));
    let file = |path: &Path| {
        let path = path.to_owned();
        move |source: io::Error| FlashError::File { path, source }
    };
    fs::write(&source, &image.bytes).map_err(file(&source))?;
    let start = format!("{:#010x}", FLASH.start);
    let common = ["-a", FLASH_SETTING, "-d", DEVICE, "-s"];
    let call = |address: &str, direction: &str, path: &Path| {
        let mut arguments: Vec<_> = common.map(Into::into).to_vec();
        arguments.extend([address.into(), direction.into(), path.as_os_str().to_owned()]);
        runner.run(way, arguments, WRITE_LIMIT)
    };
    call(&start, "-D", &source).map_err(writing)?;
    let length = image.bytes.len();
    let read = call(&format!("{start}:{length}:leave"), "-U", &copied);
    // The chip leaves the bus with the last request, which some versions report as an error. The copy decides.
    let copy = match (fs::read(&copied), read) {
        (Ok(copy), _) if copy.len() >= length => copy,
        (_, Err(source)) => return Err(writing(source)),
        (copy, Ok(_)) => copy.map_err(file(&copied))?,
    };
    compare(&image.bytes, &copy)
}

fn compare(want: &[u8], have: &[u8]) -> Result<(), FlashError> {
    let have = have.iter().copied().chain(std::iter::repeat(0));
    let different = want.iter().zip(have).enumerate().find(|(_, (want, have))| *want != have);
    match different {
        Some((offset, (want, have))) => {
            Err(FlashError::Different { way: Way::Dfu, offset, have, want: *want })
        }
        None => Ok(()),
    }
}
