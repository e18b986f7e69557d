//! The Cortex-M image in QEMU's model of an STM32F405 board.

use std::os::linux::net::SocketAddrExt;
use std::os::unix::net::{SocketAddr, UnixListener};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};
use std::{env, io, thread};

use super::{DeviceError, START_LIMIT, Started, spawn};
use crate::link::socket::Socket;
use crate::supervisor::{Process, Program, Supervisor};

/// The emulator.
const PROGRAM: &str = "qemu-system-arm";
/// Where `cargo xtask image` puts the image, below the target directory.
const IMAGE: &str = "lashloop-firmware.elf";

/// Tells the sockets of one bench apart.
static SOCKETS: AtomicU32 = AtomicU32::new(0);

/// Starts QEMU with `image`, its second UART on a socket of ours.
///
/// A socket, because QEMU looks at a pseudo-terminal only every second. One core, because the emulated processor and the
/// emulator's event loop hand the work to and fro: on two cores each hand-over is a wake-up, and a round trip takes
/// about twice as long.
pub(super) fn start(image: Option<&Path>, supervisor: &Supervisor) -> Result<Started, DeviceError> {
    let image = image.map_or_else(built_image, Path::to_owned);
    if !image.is_file() {
        return Err(DeviceError::NoImage { path: image });
    }
    let path = env::var_os("PATH").unwrap_or_default();
    if !env::split_paths(&path).any(|folder| folder.join(PROGRAM).is_file()) {
        return Err(DeviceError::NoEmulator);
    }
    let failed = |source| DeviceError::Spawn { name: "emulator", source };
    // In the abstract namespace: no file that a killed bench would leave behind.
    let socket = format!("lashloop-{}-{}", std::process::id(), SOCKETS.fetch_add(1, Ordering::Relaxed));
    let address = SocketAddr::from_abstract_name(&socket).map_err(failed)?;
    let listener = UnixListener::bind_addr(&address).map_err(failed)?;
    listener.set_nonblocking(true).map_err(failed)?;
    let process = spawn(supervisor, &program(&image, &socket))?;
    let link = accept(&listener, &process)?;
    Ok(Started { link: Box::new(link), process: Some(process) })
}

fn program(image: &Path, socket: &str) -> Program {
    let uart = format!("socket,id=uart,path={socket},abstract=on");
    let words =
        ["-M", "netduinoplus2", "-display", "none", "-monitor", "none", "-serial", "null", "-chardev"];
    let mut arguments: Vec<_> = words.map(Into::into).to_vec();
    arguments.extend([uart.into(), "-serial".into(), "chardev:uart".into(), "-kernel".into(), image.into()]);
    Program { name: "emulator", program: PROGRAM.into(), arguments, core: last_core() }
}

/// The last core this process may use: the first ones get most of a machine's other work.
fn last_core() -> Option<usize> {
    let allowed = rustix::thread::sched_getaffinity(None).ok()?;
    (0..rustix::thread::CpuSet::MAX_CPU).rev().find(|&core| allowed.is_set(core))
}

fn accept(listener: &UnixListener, process: &Process) -> Result<Socket, DeviceError> {
    let deadline = Instant::now() + START_LIMIT;
    loop {
        match listener.accept() {
            Ok((stream, _)) => {
                return Socket::new(stream)
                    .map_err(|source| DeviceError::Spawn { name: process.name(), source });
            }
            Err(error) if error.kind() != io::ErrorKind::WouldBlock => {
                return Err(DeviceError::Spawn { name: process.name(), source: error });
            }
            Err(_) if Instant::now() > deadline || process.ended_within(Duration::ZERO).is_some() => {
                return Err(DeviceError::not_up(process));
            }
            Err(_) => thread::sleep(Duration::from_millis(2)),
        }
    }
}

/// Beside the bench's own program if it stands in a target directory, else in the present one.
fn built_image() -> PathBuf {
    let beside = env::current_exe().ok().and_then(|program| {
        program.ancestors().skip(1).take(3).map(|folder| folder.join(IMAGE)).find(|image| image.is_file())
    });
    beside.unwrap_or_else(|| Path::new("target").join(IMAGE))
}
