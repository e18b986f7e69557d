//! `lashloop flash`: firmware onto a drive, confirmed by the drive itself.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use std::{fmt, thread};

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use lashloop_bench::device::{Build, Device, DeviceChoice, find_image_for_board, open_terminal};
use lashloop_bench::supervisor::Supervisor;
use lashloop_bench::verdict::Exit;
use lashloop_session::printable;

use super::error::{CliError, system};
use super::options::{BaudOption, RigOption};
use super::output::outln;
use super::supervision::start_supervisor;
use lashloop::Bench;
use lashloop::rig::file::Loader;
use lashloop::rig::lock::RigLock;
use lashloop::rig::way::Way;
use lashloop_hardware::flash::confirmation::Expected;
use lashloop_hardware::flash::program::Runner;
use lashloop_hardware::flash::{FlashError, Image, Target, confirmation, way, writer};
use lashloop_hardware::ports;

/// Write firmware to a drive, and confirm it by the drive's own report
///
/// Uses the first available way: a debug probe (probe-rs), the chip's boot loader over USB (dfu-util) or over a UART (stm32flash).
/// The flash is read back. The drive then has to report build and board of the image: only that is "flashed". A running drive
/// on --device enters its boot loader by request if a program reaches it there; without one, hold BOOT0 high during a reset
/// first. Exit code 1 if the drive reports another build or the image has none, 2 if the image is for another board, 4 if no way
/// or no drive is there.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Image of the firmware; without it, that of `cargo xtask image` for the board of the rig, else for the bare board
    elf: Option<PathBuf>,

    /// Way onto the chip; without it, the first available one
    #[arg(long, value_parser = ways())]
    via: Option<Way>,

    /// Drive after flashing, such as /dev/ttyACM0; without it, the only serial port on USB
    #[arg(long, value_name = "DEVICE", conflicts_with = "rig")]
    device: Option<DeviceChoice>,

    /// Board of the chip; needed without --rig if no drive answers that names it
    #[arg(long, value_name = "NAME", conflicts_with = "rig")]
    board: Option<String>,

    #[command(flatten)]
    rig: RigOption,

    #[command(flatten)]
    line: BaudOption,

    /// Terminal at PA9 and PA10 or PB10 and PB11 of the chip, for `uart`; without it, that of the drive, which is then sent no request to
    /// enter its boot loader
    #[arg(long, value_name = "PATH")]
    loader_port: Option<PathBuf>,

    /// Debug probe, of `probe-rs list`, for `probe`
    #[arg(long, value_name = "VID:PID:SERIAL")]
    probe: Option<String>,
}

fn ways() -> impl TypedValueParser<Value = Way> {
    let values = Way::ALL.map(|way| PossibleValue::new(way.name()).help(way.meaning()));
    let named = |name: String| Way::ALL.into_iter().find(|way| way.name() == name);
    PossibleValuesParser::new(values).try_map(move |name| named(name).ok_or("no way"))
}

impl Arguments {
    pub(crate) fn run(self, bench: &Bench) -> Result<Exit, CliError> {
        let rig = self.rig.take(bench, "flash")?;
        let rig = rig.as_ref().map(|taken| &taken.rig);
        let stated = rig.map(|rig| (rig.file.display().to_string(), rig.board.clone()));
        let stated = stated.or_else(|| self.board.map(|board| ("--board".to_owned(), board)));
        let board = stated.as_ref().map(|(_, board)| &**board);
        let found = || find_image_for_board(board).map_err(FlashError::NoImage);
        let image = Image::read(&self.elf.map_or_else(found, Ok)?).map_err(FlashError::Image)?;
        let expected = Expected::of(&image)?;
        if let Some((of, board)) = stated.as_ref().filter(|(_, board)| *board != expected.board) {
            return Err(other_board(&image, &expected, of, board, false).into());
        }
        let device = self.device.or_else(|| Some(rig?.port.without_limits().clone()));
        if let Some(simulator) = device.as_ref().filter(|device| !device.may_be_hardware()) {
            return Err(FlashError::Simulator(simulator.to_string()).into());
        }
        let baud = rig.map_or(self.line.baud, |rig| rig.port.baud);
        let Loader { via, chip, probe, port } = rig.map(|rig| rig.loader.clone()).unwrap_or_default();
        let _lock = match (&rig, &device) {
            (None, Some(device)) => Some(RigLock::take(&device.to_string(), "lashloop flash")?),
            _ => None,
        };
        let terminal = || device.as_ref()?.terminal().map(PathBuf::from);
        let loader_port = self.loader_port.or(port);
        let has_loader_port = loader_port.is_some();
        let mut target = Target {
            chip: chip.unwrap_or_else(|| image.chip.clone()),
            probe: self.probe.or(probe),
            under_reset: true,
            loader_port: loader_port.or_else(terminal),
        };
        let known = ports::on_usb();
        if device.is_none() && known.len() > 1 {
            return Err(FlashError::Ports(known.len()).into());
        }

        // A search by `uart` sends bytes.
        for port in terminal().iter().chain(&target.loader_port).filter(|port| port.exists()) {
            drop(open_terminal(port, baud)?);
        }
        let supervisor = start_supervisor()?;
        let signals = supervisor.guard_signals();
        let runner = Runner { supervisor: &supervisor };
        print_image(&image, &expected);
        let via = self.via.or(via);
        let only_port = match &known[..] {
            [port] if device.is_none() => Some(drive_at(port, bench)?),
            _ => None,
        };
        let drive = device.clone().or(only_port);
        let is_stated = stated.is_some();
        let known_drive =
            Known { image: &image, expected: &expected, is_stated, drive, baud, supervisor: &supervisor };
        let mut is_named = is_stated;
        let way = match writer::find(via, &target, &runner) {
            Ok(way) => {
                known_drive.check_chip(way, &target)?;
                way
            }
            Err(none) => {
                // Without a program for its boot loader the drive would be lost to its host.
                let is_reached = device.is_some() && way::reaches_loader(via, has_loader_port);
                let Some(drive) = is_reached.then(|| known_drive.open()).flatten() else {
                    return Err(none.into());
                };
                known_drive.check(&drive)?;
                is_named = true;
                if !enter_loader(drive) {
                    return Err(none.into());
                }
                find_loader(via, &target, &runner)?
            }
        };
        outln!("way        {}: {}", way.name(), way.meaning());
        let mut before = None;
        if way == Way::Probe {
            before = known_drive.disarm()?;
            // A probe that was found may be on another board, whose motor turns: the reset stops that one.
            let is_chosen = self.via == Some(Way::Probe) || target.probe.is_some();
            target.under_reset = !(before.is_some() && is_chosen);
            is_named |= before.is_some();
        }
        if !is_named {
            return Err(FlashError::Unnamed(expected.board).into());
        }
        let began = Instant::now();
        writer::write(way, &image, &target, &runner)?;
        let took_s = began.elapsed().as_secs_f64();
        outln!("written    {} B, read back and compared in {took_s:.1} s", image.bytes.len());
        let device = match device {
            Some(device) => device,
            None => new_port(bench, &known, &supervisor)?,
        };
        let confirmed = confirmation::confirm(way, &expected, before, &device, baud, &supervisor)?;
        drop(signals);
        print_drive(&confirmed);
        Ok(Exit::Pass)
    }
}

fn other_board(
    image: &Image,
    expected: &Expected,
    of: impl fmt::Display,
    board: &str,
    is_drive: bool,
) -> FlashError {
    let (path, image) = (image.path.clone(), expected.board.clone());
    FlashError::Board { path, image, of: of.to_string(), board: board.to_owned(), is_drive }
}

/// The image, for the drive that runs before it.
struct Known<'a> {
    image: &'a Image,
    expected: &'a Expected,
    /// The board of a rig file or an option counts, and a drive with another one has the wrong image.
    is_stated: bool,
    /// Where the drive would be.
    drive: Option<DeviceChoice>,
    baud: u32,
    supervisor: &'a Supervisor,
}

impl Known<'_> {
    /// The drive, if one answers.
    fn open(&self) -> Option<Device> {
        Device::open(self.drive.as_ref()?, self.baud, self.supervisor).ok()
    }

    /// Rejects a drive on another board than that of the image.
    fn check(&self, drive: &Device) -> Result<(), FlashError> {
        let board = drive.session.identity.board;
        if self.is_stated || board.as_str() == self.expected.board {
            return Ok(());
        }
        let of = format!("the drive on {}", drive.connection.choice);
        Err(other_board(self.image, self.expected, of, board.as_str(), true))
    }

    /// Rejects a chip in its boot loader while the drive answers elsewhere: that is another chip. A loader at the drive's own
    /// terminal needs no request, which would spoil its measurement of the speed.
    fn check_chip(&self, way: Way, target: &Target) -> Result<(), FlashError> {
        let path = |path: Option<&Path>| path.and_then(|path| path.canonicalize().ok());
        let terminal = || path(self.drive.as_ref().and_then(|drive| drive.terminal()));
        let is_elsewhere = match way {
            Way::Probe => false,
            Way::Dfu => true,
            Way::Uart => path(target.loader_port.as_deref()) != terminal(),
        };
        let Some(drive) = is_elsewhere.then(|| self.open()).flatten() else { return Ok(()) };
        self.check(&drive)?;
        Err(FlashError::AnotherChip { way, device: drive.connection.choice.to_string() })
    }

    /// Disarms a drive by a handshake before a probe halts its core. Returns the build of one that has answered.
    fn disarm(&self) -> Result<Option<Build>, FlashError> {
        const UNDER_RESET: &str = "the probe connects under reset, which needs NRST";
        let Some(drive) = self.open() else {
            match &self.drive {
                Some(device) => outln!("before     no drive answers on {device}: {UNDER_RESET}"),
                None => outln!("before     no --device to disarm: {UNDER_RESET}"),
            }
            return Ok(None);
        };
        self.check(&drive)?;
        outln!("before     {}, disarmed", drive.description());
        Ok(Some(Build::of(&drive.session.identity)))
    }
}

/// Requests a running drive to enter its boot loader. Returns whether it does.
fn enter_loader(mut drive: Device) -> bool {
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
            Err(_) if Instant::now() < deadline && !runner.supervisor.interrupted() => {
                thread::sleep(Duration::from_millis(100));
            }
            Err(FlashError::NoWay(reasons)) => return Err(FlashError::Unreached(reasons)),
            found => return found,
        }
    }
}

fn print_image(image: &Image, expected: &Expected) {
    let (size, Expected { build, board }) = (image.bytes.len(), expected);
    outln!("image      {}, {size} B, for {}, {build}", image.path.display(), printable(board));
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
            return drive_at(port, bench);
        }
        if Instant::now() >= deadline || supervisor.interrupted() {
            return Err(FlashError::Unasked { ports: present.len() }.into());
        }
        thread::sleep(Duration::from_millis(100));
    }
}

fn drive_at(port: &Path, bench: &Bench) -> Result<DeviceChoice, CliError> {
    let name = port.display().to_string();
    DeviceChoice::parse(&name, &bench.devices()).map_err(system("name the drive's port"))
}
