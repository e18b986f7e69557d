//! `qemu`: the Cortex-M image in QEMU's model of an STM32F405 board.

use std::path::{Path, PathBuf};

use crate::device::drive_host::{DriveHost, START_LIMIT, spawn};
use crate::device::error::DeviceError;
use crate::device::evidence::DriveFiles;
use crate::device::image;
use crate::device::kind::{DeviceKind, Opened, ParsedKind, Syntax};
use crate::device::uart_socket::UartSocket;
use crate::supervisor::{Program, Supervisor, find_program};

/// The emulator.
const PROGRAM: &str = "qemu-system-arm";
const NOT_INSTALLED: &str = "qemu-system-arm is not installed: `cargo xtask setup` installs it, or on Debian `apt-get install \
                             qemu-system-arm`";

const NAME: &str = "qemu";

pub(in crate::device) const SYNTAX: Syntax = Syntax { form: "qemu, qemu:ELF", parse };

fn parse(text: &str) -> Option<ParsedKind> {
    let kind = |image| Box::new(Emulator { image }) as Box<dyn DeviceKind>;
    image::parse(NAME, text).map(|image| image.map(kind))
}

/// The emulator, started by the bench.
#[derive(Debug, Clone)]
pub struct Emulator {
    /// The image to run; `None` for the one that is found.
    pub image: Option<PathBuf>,
}

impl DeviceKind for Emulator {
    fn name(&self) -> String {
        image::name(NAME, self.image.as_deref())
    }

    fn open(&self, _baud: u32, supervisor: &Supervisor) -> Result<Opened, DeviceError> {
        start(self.image.as_deref(), supervisor)
    }

    fn files(&self, _supervisor: &Supervisor) -> DriveFiles {
        let paths = image::find(NAME, self.image.as_deref()).into_iter().collect();
        DriveFiles { paths, rebuilt_by: Some("cargo xtask image") }
    }
}

/// Starts QEMU with `image`, its second UART on a socket of the bench.
///
/// A socket, because QEMU polls a pseudo-terminal only once a second. One core, because the emulated processor and the
/// emulator's event loop alternate: on two cores each change is a wake-up, and a round trip takes about twice as long.
fn start(image: Option<&Path>, supervisor: &Supervisor) -> Result<Opened, DeviceError> {
    let image = image::find(NAME, image)?;
    let emulator = find_program(PROGRAM).map_err(|_| DeviceError::Missing(NOT_INSTALLED.to_owned()))?;
    let socket = UartSocket::listen().map_err(|source| DeviceError::Spawn { name: "emulator", source })?;
    let process = spawn(supervisor, &program(emulator, &image, &socket.name))?;
    let link = socket.accept(&process, START_LIMIT)?;
    Ok(Opened { link: Box::new(link), host: DriveHost::Process(process) })
}

fn program(emulator: PathBuf, image: &Path, socket: &str) -> Program {
    let uart = format!("socket,id=uart,path={socket},abstract=on");
    let options =
        ["-M", "netduinoplus2", "-display", "none", "-monitor", "none", "-serial", "null", "-chardev"];
    let mut arguments: Vec<_> = options.map(Into::into).to_vec();
    arguments.extend([uart.into(), "-serial".into(), "chardev:uart".into(), "-kernel".into(), image.into()]);
    Program { name: "emulator", program: emulator.into(), arguments, core: last_core() }
}

/// The last core that this process may use: the first ones carry most of a machine's other load.
fn last_core() -> Option<usize> {
    let allowed = rustix::thread::sched_getaffinity(None).ok()?;
    (0..rustix::thread::CpuSet::MAX_CPU).rev().find(|&core| allowed.is_set(core))
}
