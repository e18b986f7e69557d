//! A debug probe, by probe-rs. It halts the core, so the firmware on the chip doesn't matter.
//!
//! A halted core leaves a power stage at its last duty until the independent watchdog resets the chip. In reset the pins are
//! inputs.

use std::ffi::OsString;
use std::time::Duration;

use super::image::Image;
use super::program::{ProgramError, Runner};
use super::target::Target;
use lashloop::rig::way::Way;

const LOOK_LIMIT: Duration = Duration::from_secs(10);
const WRITE_LIMIT: Duration = Duration::from_secs(120);
const RESET_LIMIT: Duration = Duration::from_secs(20);

/// Whether the way is there.
///
/// # Errors
/// What is missing, as a sentence.
pub(super) fn look(target: &Target, runner: &Runner<'_>) -> Result<(), String> {
    let output = runner.run(Way::Probe, ["list"], LOOK_LIMIT).map_err(|error| error.to_string())?;
    // A probe is a line such as "[0]: STLink V2 -- 0483:3748:003700..".
    let probes = output.lines().filter(|line| line.trim_start().starts_with('[')).count();
    match (probes, &target.probe) {
        (0, _) => Err("probe-rs finds no debug probe: connect one, and power it".to_owned()),
        (1, _) | (_, Some(_)) => Ok(()),
        (_, None) => Err(format!(
            "probe-rs finds {probes} debug probes: choose one of `probe-rs list` by --probe, or by loader.probe of the rig file"
        )),
    }
}

/// Writes the ELF, compares it with the flash, and resets the chip.
pub(super) fn write(image: &Image, target: &Target, runner: &Runner<'_>) -> Result<(), ProgramError> {
    let mut download = arguments("download", target);
    if target.under_reset {
        download.push("--connect-under-reset".into());
    }
    download.extend(["--verify".into(), image.path.clone().into_os_string()]);
    runner.run(Way::Probe, download, WRITE_LIMIT)?;
    runner.run(Way::Probe, arguments("reset", target), RESET_LIMIT).map(drop)
}

fn arguments(verb: &str, target: &Target) -> Vec<OsString> {
    let mut arguments: Vec<OsString> = [verb, "--chip", &target.chip].map(Into::into).to_vec();
    if let Some(probe) = &target.probe {
        arguments.extend(["--probe".into(), probe.into()]);
    }
    arguments
}
