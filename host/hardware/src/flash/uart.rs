//! The boot loader in ROM over a UART, by stm32flash (ST AN3155).

use std::ffi::OsString;
use std::fs;
use std::path::Path;
use std::time::Duration;

use super::error::FlashError;
use super::image::{FLASH, Image};
use super::program::Runner;
use super::target::Target;
use lashloop::rig::way::Way;

/// The loader measures the speed once after a reset, so every call uses the same.
const BAUD: &str = "115200";
const LOOK_LIMIT: Duration = Duration::from_secs(20);
/// 1 MiB takes 91 s each way at this speed.
const WRITE_LIMIT: Duration = Duration::from_secs(240);

/// Whether the way is there. Sends a few bytes to the port; a running drive counts them as damage.
///
/// # Errors
/// What is missing, as a sentence.
pub(super) fn look(target: &Target, runner: &Runner<'_>) -> Result<(), String> {
    let port = port(target)?;
    if !port.exists() {
        return Err(format!("there is no {}", port.display()));
    }
    let found = runner.run(Way::Uart, arguments(&[], port), LOOK_LIMIT);
    found.map(drop).map_err(|error| {
        format!(
            "no boot loader answers on {} ({error}): hold BOOT0 high during a reset; the loader listens on USART1 and USART3 (PA9 and \
             PA10, PB10 and PB11), not on the pins of the drive's link",
            port.display()
        )
    })
}

/// Writes the bytes, reads them back and starts the firmware. `folder` takes the file that stm32flash reads.
pub(super) fn write(
    image: &Image,
    target: &Target,
    folder: &Path,
    runner: &Runner<'_>,
) -> Result<(), FlashError> {
    let way = Way::Uart;
    let port = port(target).map_err(|problem| FlashError::NoWay(vec![(way, problem)]))?;
    let source = folder.join("image.bin");
    fs::write(&source, &image.bytes)
        .map_err(|error| FlashError::File { path: source.clone(), source: error })?;
    let start = format!("{:#010x}", FLASH.start);
    // With a length, because the whole chip is erased without one.
    let range = format!("{start}:{}", image.bytes.len());
    let options = [
        "-f".into(),
        "-v".into(),
        "-w".into(),
        source.into_os_string(),
        "-S".into(),
        range.into(),
        "-g".into(),
        start.into(),
    ];
    runner
        .run(way, arguments(&options, port), WRITE_LIMIT)
        .map_err(|source| FlashError::Writing { way, source })?;
    Ok(())
}

fn port(target: &Target) -> Result<&Path, String> {
    target.loader_port.as_deref().ok_or_else(|| {
        "no port of the boot loader is given: name the terminal at PA9 and PA10 or PB10 and PB11 by --loader-port"
            .to_owned()
    })
}

fn arguments(options: &[OsString], port: &Path) -> Vec<OsString> {
    let mut arguments: Vec<OsString> = ["-b", BAUD, "-m", Target::line_format(port)].map(Into::into).to_vec();
    arguments.extend_from_slice(options);
    arguments.push(port.into());
    arguments
}
