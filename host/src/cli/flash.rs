//! `lashloop flash`: firmware onto a drive, confirmed by the drive itself.

use std::path::PathBuf;
use std::time::{Duration, Instant};
use std::{io, thread};

use clap::Args;
use lashloop_bench::device::{Build, Device, DeviceChoice, find_image, open_terminal};
use lashloop_bench::session::printable;
use lashloop_bench::supervisor::Supervisor;
use lashloop_bench::verdict::Exit;

use super::error::CliError;
use super::options::{BaudOption, RigOption};
use super::output::outln;
use super::supervision::start_supervisor;
use crate::bench::Bench;
use crate::flash::program::Runner;
use crate::flash::{FlashError, Image, Target, Way, confirmation, way, writer};
use crate::ports;
use crate::rig::check::check_board;
use crate::rig::file::Loader;

/// Write firmware to a drive, and confirm it by the drive's own report
///
/// Finds the way that is there: a debug probe (probe-rs), the chip's boot loader over USB (dfu-util) or over a UART (stm32flash).
/// The flash is read back. The drive then has to report the build of the image: only that is "flashed". For the boot loader hold
/// BOOT0 high during a reset first. Exit code 1 if the drive reports another build, 4 if no way or no drive is there.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Image of the firmware; without it, that of `cargo xtask image`, found as for `--device qemu`
    elf: Option<PathBuf>,

    /// Way onto the chip; without it, the first one that is there
    #[arg(long)]
    via: Option<Way>,

    /// Drive after flashing, such as /dev/ttyACM0; without it, the only serial port on USB
    #[arg(long, value_name = "DEVICE", conflicts_with = "rig")]
    device: Option<DeviceChoice>,

    #[command(flatten)]
    rig: RigOption,

    #[command(flatten)]
    line: BaudOption,

    /// Terminal at USART1 or USART3 of the chip, for `uart`; without it, that of the drive
    #[arg(long, value_name = "PATH")]
    loader_port: Option<PathBuf>,

    /// Debug probe, of `probe-rs list`, for `probe`
    #[arg(long, value_name = "VID:PID:SERIAL")]
    probe: Option<String>,
}

impl Arguments {
    pub(crate) fn run(self, bench: &Bench) -> Result<Exit, CliError> {
        let image = find_image("qemu", self.elf.as_deref()).map_err(FlashError::NoImage)?;
        let image = Image::read(&image).map_err(FlashError::Image)?;
        let rig = self.rig.take(bench, "flash")?;
        let rig = rig.as_ref().map(|taken| &taken.rig);
        let device = self.device.or_else(|| Some(rig?.port.device.clone()));
        let baud = rig.map_or(self.line.baud, |rig| rig.port.baud);
        let Loader { via, chip, probe, port } = rig.map(|rig| rig.loader.clone()).unwrap_or_default();
        let terminal = || device.as_ref()?.terminal().map(PathBuf::from);
        let target = Target {
            chip,
            probe: self.probe.or(probe),
            loader_port: self.loader_port.or(port).or_else(terminal),
        };
        let known = ports::on_usb();
        if device.is_none() && known.len() > 1 {
            return Err(FlashError::Ports(known.len()).into());
        }

        let supervisor = start_supervisor()?;
        let signals = supervisor.guard_signals();
        let interrupted = || supervisor.interrupted();
        let runner = Runner { interrupted: &interrupted };
        print_image(&image);
        let via = self.via.or(via);
        let way = writer::find(via, &target, &runner).or_else(|none| {
            // Without a program for its boot loader the drive would be lost to its host.
            let has_program = way::installed(via).into_iter().any(|way| way != Way::Probe);
            let drive = device.as_ref().filter(|_| has_program);
            if drive.is_some_and(|drive| enter_loader(drive, baud, &supervisor)) {
                find_loader(via, &target, &runner)
            } else {
                Err(none)
            }
        })?;
        outln!("way        {}: {}", way.name(), way.meaning());
        if let Some(device) = &device {
            quiet(way, device, baud, &supervisor)?;
        }
        let began = Instant::now();
        writer::write(way, &image, &target, &runner)?;
        let took_s = began.elapsed().as_secs_f64();
        outln!("written    {} B, read back and compared in {took_s:.1} s", image.bytes.len());
        let device = match device {
            Some(device) => device,
            None => new_port(bench, &known, &supervisor)?,
        };
        let confirmed = confirmation::confirm(way, &image, &device, baud, &supervisor)?;
        drop(signals);
        if let Some(rig) = rig {
            check_board(rig, &confirmed)?;
        }
        print_drive(&confirmed);
        Ok(Exit::Pass)
    }
}

/// Requests a running drive to enter its boot loader. Returns whether it does.
fn enter_loader(device: &DeviceChoice, baud: u32, supervisor: &Supervisor) -> bool {
    let Ok(mut drive) = Device::open(device, baud, supervisor) else { return false };
    let description = drive.description();
    let entered = drive.session.enter_loader();
    match &entered {
        Ok(()) => outln!("before     {description} enters its boot loader"),
        Err(error) => outln!("before     {description} enters no boot loader: {error}"),
    }
    entered.is_ok()
}

/// Waits for a boot loader that a drive has just entered.
///
/// # Errors
/// [`FlashError::Unreached`]: none is there in time.
fn find_loader(via: Option<Way>, target: &Target, runner: &Runner<'_>) -> Result<Way, FlashError> {
    /// Time for the reset, and for the enumeration of a USB port.
    const LIMIT: Duration = Duration::from_secs(10);
    let deadline = Instant::now() + LIMIT;
    loop {
        match writer::find(via, target, runner) {
            Err(_) if Instant::now() < deadline && !(runner.interrupted)() => {
                thread::sleep(Duration::from_millis(100));
            }
            Err(FlashError::NoWay(reasons)) => return Err(FlashError::Unreached(reasons)),
            found => return found,
        }
    }
}

/// Leaves no motion and no other program on the drive before its firmware stops. A probe halts the core, and a halted core
/// leaves the power stage at its last duty; the handshake disarms. A chip in its boot loader drives nothing, and bytes of a
/// handshake would spoil its measurement of the speed.
///
/// # Errors
/// Another program holds the port, or it can't be opened.
fn quiet(way: Way, device: &DeviceChoice, baud: u32, supervisor: &Supervisor) -> Result<(), CliError> {
    let Some(terminal) = device.terminal().filter(|terminal| terminal.exists()) else { return Ok(()) };
    drop(open_terminal(terminal, baud)?);
    if way == Way::Probe {
        match Device::open(device, baud, supervisor) {
            Ok(drive) => outln!("before     {}, disarmed", drive.description()),
            Err(_) => outln!("before     no drive answers on {device}"),
        }
    }
    Ok(())
}

fn print_image(image: &Image) {
    let Image { path, bytes, build } = image;
    let build = build.map_or_else(|| "no build to compare".to_owned(), |build| build.to_string());
    outln!("image      {}, {} B, {build}", path.display(), bytes.len());
    outln!("sha256     {}", image.sha256());
}

fn print_drive(drive: &Device) {
    let identity = &drive.session.identity;
    let (board, firmware, build) =
        (printable(identity.board.as_str()), identity.firmware, Build::of(identity));
    outln!(
        "flashed    the drive on {} reports {board}, firmware {firmware}, {build}",
        drive.connection.choice
    );
}

/// The drive's port: the only one on USB, or the first one that appears after flashing.
fn new_port(bench: &Bench, known: &[PathBuf], supervisor: &Supervisor) -> Result<DeviceChoice, CliError> {
    const LIMIT: Duration = Duration::from_secs(15);
    let deadline = Instant::now() + LIMIT;
    loop {
        let present = ports::on_usb();
        let new = present.iter().find(|port| !known.contains(port)).or(match &present[..] {
            [only] if !known.is_empty() => Some(only),
            _ => None,
        });
        if let Some(port) = new {
            let name = port.display().to_string();
            return DeviceChoice::parse(&name, &bench.devices()).map_err(|problem| CliError::System {
                what: "name the drive's port",
                source: io::Error::other(problem),
            });
        }
        if Instant::now() >= deadline || supervisor.interrupted() {
            return Err(FlashError::Ports(present.len()).into());
        }
        thread::sleep(Duration::from_millis(100));
    }
}
