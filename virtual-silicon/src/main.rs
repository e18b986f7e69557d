//! `lashloop-silicon`: an image on virtual silicon, its link on standard input and output or on a socket.
//!
//! It ends when the host disconnects, or at the first access of the image that the chip would not have served. The latter is a
//! report on standard error and the exit code 1; an image that can't run is 2.

use std::ops::ControlFlow;
use std::os::linux::net::SocketAddrExt;
use std::os::unix::net::{SocketAddr, UnixStream};
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;
use std::{fs, io};

use anyhow::{Context, Result};
use clap::Parser;
use lashloop_silicon::boards;
use lashloop_silicon::drive_train::DriveTrain;
use lashloop_silicon::drive_train_file;
use lashloop_silicon::host_link::{Clock, HostLink};
use lashloop_silicon::machine;
use lashloop_silicon::pins::Pins;
use lashloop_silicon::surroundings::{End, Surroundings};
use lashloop_silicon::symbols::Symbols;

/// Run an image of the drive on register-level models of its chip
#[derive(Parser)]
struct Arguments {
    /// The image
    image: PathBuf,

    /// Board with its pins, or a file of them, whose name ends in .toml; without this option the board that the image is for,
    /// stm32f405 for an image that names none
    #[arg(long, value_name = "NAME|FILE")]
    board: Option<String>,

    /// Abstract socket to connect the link to, instead of standard input and output
    #[arg(long, value_name = "NAME")]
    socket: Option<String>,

    /// Let device time stand still while the drive waits for its host, instead of following the wall clock
    #[arg(long)]
    lockstep: bool,

    /// Description in JSON of the drive train between bridge and encoders; without one their wires are open
    #[arg(long, value_name = "FILE")]
    drive_train: Option<PathBuf>,
}

/// Device time at which the host is connected. The image has configured its USART by then, and what the emulation takes for the
/// start of it isn't part of a handshake.
const BOOTED_AT: Duration = Duration::from_millis(20);

/// Connects the host.
type Connect = Box<dyn FnOnce() -> Result<HostLink> + Send>;

/// A host, and a drive train or open wires at the pins.
struct Bench {
    connect: Option<Connect>,
    host: Option<HostLink>,
    /// Device time of the host's next turn.
    host_turn: Duration,
    train: Option<DriveTrain>,
}

impl Bench {
    fn take_turns(&mut self, chip: &mut Pins<'_>) -> Result<ControlFlow<End, Duration>> {
        let train_turn = self.train.as_mut().map(|train| train.turn(chip)).transpose()?;
        if self.host_turn <= chip.now() {
            if let Some(connect) = self.connect.take() {
                self.host = Some(connect()?);
            }
            match self.host.as_mut().map(|host| host.turn(chip)) {
                Some(ControlFlow::Continue(turn)) => self.host_turn = turn,
                Some(ControlFlow::Break(end)) => return Ok(ControlFlow::Break(end)),
                None => self.host_turn = Duration::MAX,
            }
        }
        Ok(ControlFlow::Continue(self.host_turn.min(train_turn.unwrap_or(Duration::MAX))))
    }
}

impl Surroundings for Bench {
    fn turn(&mut self, chip: &mut Pins<'_>) -> ControlFlow<End, Duration> {
        self.take_turns(chip).unwrap_or_else(|error| {
            eprintln!("lashloop-silicon: {error:#}");
            ControlFlow::Break(End::Failed)
        })
    }
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(error) => {
            eprintln!("lashloop-silicon: {error:#}");
            ExitCode::from(2)
        }
    }
}

/// Runs the image, and returns whether the chip has served all its accesses.
fn run(Arguments { image, board, socket, lockstep, drive_train }: &Arguments) -> Result<bool> {
    let clock = if *lockstep { Clock::Lockstep } else { Clock::Wall };
    let connect: Connect = match socket.clone() {
        Some(name) => Box::new(move || {
            let stream = UnixStream::connect_addr(&SocketAddr::from_abstract_name(&name)?);
            let stream = stream.with_context(|| format!("no socket {name}"))?;
            Ok(HostLink::new(stream.try_clone()?, stream, clock))
        }),
        None => Box::new(move || Ok(HostLink::new(io::stdin(), io::stdout(), clock))),
    };
    let train = drive_train.as_ref().map(|path| {
        let text = fs::read_to_string(path).with_context(|| format!("{} can't be read", path.display()))?;
        drive_train_file::read(&text).with_context(|| path.display().to_string())
    });
    let train = train.transpose()?;
    let symbols = Symbols::read(image)?;
    let image = symbols.image()?;
    let board = match board {
        Some(board) => Some(board.clone()),
        None => symbols.board()?,
    };
    let wiring = boards::open(board.as_deref().unwrap_or(boards::DEFAULT))?;
    let surroundings = Bench { connect: Some(connect), host: None, host_turn: BOOTED_AT, train };
    let ended = machine::run(image, wiring, surroundings)?;
    if !ended.violations.is_empty() {
        let milliseconds = ended.device_time.as_millis();
        eprintln!(
            "lashloop-silicon: after {milliseconds} ms the image made an access that the chip doesn't serve"
        );
        eprintln!("{}", ended.violations);
    }
    Ok(ended.violations.is_empty() && ended.end != Some(End::Failed))
}
