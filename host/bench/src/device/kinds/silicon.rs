//! `silicon`: the Cortex-M image on virtual silicon, a process of its own with register-level models of the chip.
//!
//! QEMU's board has no clock tree, encoder timers or PWM. Virtual silicon has, and ends with a report at the first access
//! of the image that the chip would not serve.

use std::env;
use std::ffi::OsString;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use tempfile::NamedTempFile;

use crate::device::drive_host::{DriveHost, spawn};
use crate::device::error::{DeviceError, listed};
use crate::device::evidence::DriveFiles;
use crate::device::image;
use crate::device::kind::{DeviceKind, Opened, ParsedKind, Syntax, session_number};
use crate::device::pin_plant::PinPlant;
use crate::device::slow_time::SlowTime;
use crate::device::uart_socket::UartSocket;
use crate::supervisor::{Program, Supervisor};
use crate::timing::ClockName;

/// Name of the program that `cargo xtask silicon` builds.
const PROGRAM: &str = "lashloop-silicon";
/// Variable of the environment with the path of the program.
const VARIABLE: &str = "LASHLOOP_SILICON";
/// Where the build puts the program.
const BUILT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../target/virtual-silicon/release");
/// The part of the process in messages.
const PROCESS: &str = "virtual silicon";

/// Time until the program connects: it translates the image for the processor of this machine first.
const CONNECT_LIMIT: Duration = Duration::from_secs(30);

const NAME: &str = "silicon";

pub(in crate::device) const SYNTAX: Syntax = Syntax { form: "silicon, silicon:ELF", parse };

fn parse(text: &str) -> Option<ParsedKind> {
    let kind = |image| Box::new(Silicon { image, pins: None }) as Box<dyn DeviceKind>;
    image::parse(NAME, text).map(|image| image.map(kind))
}

/// Virtual silicon, started by the bench.
#[derive(Debug, Clone)]
pub struct Silicon {
    /// The image to run; `None` for the one that is found.
    pub image: Option<PathBuf>,
    /// The plant behind the pins; `None` for open wires, as in HIL mode.
    pub pins: Option<PinPlant>,
}

impl Silicon {
    fn is_lockstep(&self) -> bool {
        self.pins.as_ref().is_some_and(|pins| pins.clock == ClockName::Lockstep)
    }
}

impl DeviceKind for Silicon {
    fn name(&self) -> String {
        image::name(NAME, self.image.as_deref())
    }

    fn open(&self, _baud: u32, supervisor: &Supervisor) -> Result<Opened, DeviceError> {
        let image = image::find(NAME, self.image.as_deref())?;
        let program = find_program(env::var_os(VARIABLE), env::current_exe().ok().as_deref())?;
        let socket = UartSocket::listen().map_err(|source| DeviceError::Spawn { name: PROCESS, source })?;
        let mut arguments = vec![image.into(), "--socket".into(), socket.name.clone().into()];
        // Until the program has connected: it has read the file then.
        let mut description = None;
        if let Some(pins) = &self.pins {
            let file = description.insert(write_description(pins, NAME)?);
            arguments.extend(["--drive-train".into(), file.path().into()]);
            if self.is_lockstep() {
                arguments.push("--lockstep".into());
            }
        }
        let program = Program { name: PROCESS, program: program.into(), arguments, core: None };
        let process = spawn(supervisor, &program)?;
        let link = socket.accept(&process, CONNECT_LIMIT)?;
        drop(description);
        let host = DriveHost::Process(process);
        if self.is_lockstep() {
            return Ok(Opened { link: Box::new(SlowTime::new(link)), host });
        }
        Ok(Opened { link: Box::new(link), host })
    }

    fn with_plant(&self, pins: &PinPlant) -> Result<Option<Box<dyn DeviceKind>>, DeviceError> {
        Ok(Some(Box::new(Self { image: self.image.clone(), pins: Some(pins.clone()) })))
    }

    /// In lockstep the same in every run: it is in frames, and their bytes decide how long the chip works on them.
    fn session_number(&self) -> u32 {
        if self.is_lockstep() { 1 } else { session_number() }
    }

    fn keeps_bench_clock(&self, clock: ClockName) -> bool {
        self.pins.as_ref().is_some_and(|pins| pins.clock == clock)
    }

    fn files(&self, _supervisor: &Supervisor) -> DriveFiles {
        let image = image::find(NAME, self.image.as_deref()).into_iter();
        let program = find_program(env::var_os(VARIABLE), env::current_exe().ok().as_deref());
        DriveFiles { paths: image.chain(program).collect(), rebuilt_by: Some("cargo xtask image") }
    }
}

/// Writes the description of a plant to a temporary file, for the device of this name.
fn write_description(pins: &PinPlant, device: &str) -> Result<NamedTempFile, DeviceError> {
    let text = pins.description(pins.torque_per_duty_nm(device)?);
    let written = text.map_err(io::Error::from).and_then(|text| {
        let mut file = NamedTempFile::new()?;
        file.write_all(&text)?;
        Ok(file)
    });
    written.map_err(|source| DeviceError::Spawn { name: PROCESS, source })
}

/// The program: the one that the environment names, else the one that was built, else the one next to this program.
///
/// # Errors
/// No program is there; the error lists the places.
fn find_program(variable: Option<OsString>, this: Option<&Path>) -> Result<PathBuf, DeviceError> {
    let places = match variable.filter(|program| !program.is_empty()) {
        Some(program) => vec![program.into()],
        None => [Path::new(BUILT)].into_iter().chain(this.and_then(Path::parent)).map(place).collect(),
    };
    image::first(places).map_err(|places| {
        let places = listed(&places);
        DeviceError::Missing(format!("no virtual silicon at {places}: build it with `cargo xtask silicon`"))
    })
}

/// The program in a folder, without the `..` of its path if the folder exists.
fn place(folder: &Path) -> PathBuf {
    folder.canonicalize().unwrap_or_else(|_| folder.to_owned()).join(PROGRAM)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missing_program_is_reported_with_its_places() {
        let missing = find_program(Some("no/such/program".into()), None).unwrap_err();
        let want = "no virtual silicon at no/such/program: build it with `cargo xtask silicon`";
        assert_eq!(missing.to_string(), want);
    }

    #[test]
    fn the_program_next_to_this_one_is_found_after_the_built_one() {
        let folder = tempfile::tempdir().unwrap();
        let program = folder.path().canonicalize().unwrap().join(PROGRAM);
        std::fs::write(&program, "").unwrap();
        let this = folder.path().join("lashloop");
        let found = find_program(Some(OsString::new()), Some(&this)).unwrap();
        assert!(found == program || found.starts_with(Path::new(BUILT).canonicalize().unwrap()), "{found:?}");
    }
}
