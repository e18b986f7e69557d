//! The drive a run is made with: which one, how it is reached, and who has to be started for it.

mod error;
mod qemu;
pub mod twin;

use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};
use std::{fmt, io};

pub use error::DeviceError;
use lashloop_protocol::message::Identity;

use crate::fault::link::LinkFaults;
use crate::link::in_process::InProcess;
use crate::link::pty::{self, Pty};
use crate::link::reopening::Reopening;
use crate::link::serial::Serial;
use crate::link::uart_model::UartModel;
use crate::link::{Link, LinkError};
use crate::scenario::Scenario;
use crate::scenario::sections::LinkSettings;
use crate::session::{Session, SessionError, printable};
use crate::supervisor::{Process, Program, Supervisor};

/// How long a program may take to come up.
const START_LIMIT: Duration = Duration::from_secs(5);

/// Which drive.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum DeviceChoice {
    /// The drive in this process, called directly.
    InProcess,
    /// The native twin, a process of its own on a pseudo-terminal.
    Native,
    /// The Cortex-M image in QEMU; `None` for the image the build puts into `target`.
    Qemu(Option<PathBuf>),
    /// Whatever answers on this terminal.
    Terminal(PathBuf),
}

impl FromStr for DeviceChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "inproc" => Ok(Self::InProcess),
            "native" => Ok(Self::Native),
            "qemu" => Ok(Self::Qemu(None)),
            _ => match text.strip_prefix("qemu:") {
                Some("") => Err("qemu: wants the path of an image after the colon".to_owned()),
                Some(image) => Ok(Self::Qemu(Some(image.into()))),
                None if text.contains('/') => Ok(Self::Terminal(text.into())),
                None => {
                    Err("expected inproc, native, qemu, qemu:ELF or the path of a terminal like /dev/ttyACM0"
                        .to_owned())
                }
            },
        }
    }
}

impl fmt::Display for DeviceChoice {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::InProcess => write!(out, "inproc"),
            Self::Native => write!(out, "native"),
            Self::Qemu(None) => write!(out, "qemu"),
            Self::Qemu(Some(image)) => write!(out, "qemu:{}", image.display()),
            Self::Terminal(path) => write!(out, "{}", path.display()),
        }
    }
}

/// How fast the bits of a line are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LineSpeed {
    /// Bits a second of a serial port; no other line has a speed.
    pub baud: u32,
    /// The wire that is modelled on a line without one.
    pub modelled_baud: Option<u32>,
}

impl From<u32> for LineSpeed {
    /// Without a modelled wire.
    fn from(baud: u32) -> Self {
        Self { baud, modelled_baud: None }
    }
}

impl From<&LinkSettings> for LineSpeed {
    fn from(link: &LinkSettings) -> Self {
        Self { baud: link.baud, modelled_baud: link.modelled_baud() }
    }
}

/// A drive that has been greeted, with the process behind it if the bench started one.
pub struct Device {
    /// The conversation.
    pub session: Session,
    connection: Connection,
    link_faults: Option<LinkFaults>,
}

impl Device {
    /// Starts what has to be started, opens the link and greets the drive.
    ///
    /// # Errors
    /// A sentence that says what could not be reached, and what to do.
    pub fn open(
        choice: &DeviceChoice,
        speed: impl Into<LineSpeed>,
        supervisor: &Supervisor,
    ) -> Result<Self, DeviceError> {
        Self::open_through(choice, speed, supervisor, |link| link)
    }

    /// The same, with a middleware around the link, from its first byte on.
    ///
    /// # Errors
    /// A sentence that says what could not be reached, and what to do.
    pub fn open_through(
        choice: &DeviceChoice,
        speed: impl Into<LineSpeed>,
        supervisor: &Supervisor,
        middleware: impl FnOnce(Box<dyn Link>) -> Box<dyn Link>,
    ) -> Result<Self, DeviceError> {
        let (link, connection) = Connection::open(choice, speed, supervisor)?;
        let session =
            Session::open(middleware(link), session_number()).map_err(|source| connection.explain(source))?;
        Ok(Self { session, connection, link_faults: None })
    }

    /// Opens it for a scenario: at its speed, and with its faults on the line. The middleware is between those and the
    /// bench.
    ///
    /// # Errors
    /// A sentence that says what could not be reached, and what to do.
    pub fn open_for(
        scenario: &Scenario,
        choice: &DeviceChoice,
        supervisor: &Supervisor,
        middleware: impl FnOnce(Box<dyn Link>) -> Box<dyn Link>,
    ) -> Result<Self, DeviceError> {
        let faults = LinkFaults::new(scenario);
        let tamper = |link| match &faults {
            Some(faults) => faults.wrap(link, scenario),
            None => link,
        };
        let device = Self::open_through(choice, &scenario.link, supervisor, |link| middleware(tamper(link)))?;
        Ok(device.with_link_faults(faults))
    }

    /// Tells of the faults that its link was wrapped in, so that a run can steer them.
    #[must_use]
    pub fn with_link_faults(mut self, faults: Option<LinkFaults>) -> Self {
        self.link_faults = faults;
        self
    }

    /// The faults on its line.
    #[must_use]
    pub fn link_faults(&self) -> Option<&LinkFaults> {
        self.link_faults.as_ref()
    }

    /// What the run was made with, in words.
    #[must_use]
    pub fn description(&self) -> String {
        self.connection.description(self.session.identity())
    }

    /// The choice this device was opened by.
    #[must_use]
    pub fn choice(&self) -> &DeviceChoice {
        &self.connection.choice
    }

    /// The process behind the drive, if the bench started one.
    #[must_use]
    pub fn process(&self) -> Option<&Process> {
        self.connection.process.as_ref()
    }

    /// An error of the conversation as an error of this device: with its name, and with what became of its process.
    #[must_use]
    pub fn explain(&self, source: SessionError) -> DeviceError {
        self.connection.explain(source)
    }

    /// The error for a drive that keeps to the protocol but can't serve this bench.
    #[must_use]
    pub fn unfit(&self, problem: String) -> DeviceError {
        DeviceError::Unfit { device: self.connection.choice.to_string(), problem }
    }
}

/// What is behind a link: which drive was chosen, and the process behind it if the bench started one.
pub struct Connection {
    choice: DeviceChoice,
    process: Option<Process>,
    modelled_baud: Option<u32>,
}

impl Connection {
    /// Starts what has to be started and opens the link, without a word to the drive.
    ///
    /// # Errors
    /// A sentence that says what could not be reached, and what to do; a wire is to be modelled on a line that has one.
    pub fn open(
        choice: &DeviceChoice,
        speed: impl Into<LineSpeed>,
        supervisor: &Supervisor,
    ) -> Result<(Box<dyn Link>, Self), DeviceError> {
        let LineSpeed { baud, modelled_baud } = speed.into();
        if let (Some(_), DeviceChoice::Terminal(path)) = (modelled_baud, choice)
            && !is_pseudo_terminal(&resolved(path)?)
        {
            return Err(DeviceError::HasWire { path: path.clone(), baud });
        }
        let Started { link, process } = match choice {
            DeviceChoice::InProcess => Started { link: Box::new(InProcess::default()), process: None },
            DeviceChoice::Native => start_twin(supervisor)?,
            DeviceChoice::Qemu(image) => qemu::start(image.as_deref(), supervisor)?,
            DeviceChoice::Terminal(path) => Started { link: open_terminal(path, baud)?, process: None },
        };
        let link = match modelled_baud {
            Some(baud) => Box::new(UartModel::new(link, baud)),
            None => link,
        };
        Ok((link, Self { choice: choice.clone(), process, modelled_baud }))
    }

    /// What was chosen and who answered, in words.
    #[must_use]
    pub fn description(&self, identity: &Identity) -> String {
        let wire =
            self.modelled_baud.map_or_else(String::new, |baud| format!(", wire modelled at {baud} Bd"));
        format!(
            "{} ({}, firmware {}, build {:08x}){wire}",
            self.choice,
            printable(identity.board.as_str()),
            identity.firmware,
            identity.build_id
        )
    }

    /// An error of the conversation as an error of this device: with its name, and with what became of its process.
    #[must_use]
    pub fn explain(&self, source: SessionError) -> DeviceError {
        explain(&self.choice, self.process.as_ref(), source)
    }
}

/// A link to a drive nobody has greeted yet.
struct Started {
    link: Box<dyn Link>,
    process: Option<Process>,
}

fn start_twin(supervisor: &Supervisor) -> Result<Started, DeviceError> {
    let program = Program {
        name: "native twin",
        program: supervisor.bench(),
        arguments: vec!["device".into()],
        core: None,
    };
    let process = spawn(supervisor, &program)?;
    let Some(path) = process.next_line(Instant::now() + START_LIMIT) else {
        return Err(DeviceError::not_up(&process));
    };
    let link = open_terminal(Path::new(&path), 0)?;
    Ok(Started { link, process: Some(process) })
}

fn spawn(supervisor: &Supervisor, program: &Program) -> Result<Process, DeviceError> {
    supervisor.spawn(program).map_err(|source| DeviceError::Spawn { name: program.name, source })
}

/// Opens whatever terminal this is, for nobody else. `baud` is for serial ports.
pub fn open_terminal(path: &Path, baud: u32) -> Result<Box<dyn Link>, DeviceError> {
    let open = move |path: &PathBuf| -> io::Result<Box<dyn Link>> {
        // A name under /dev/serial/by-id, or any other link, stands for what it points to at that time.
        let path = path.canonicalize()?;
        if is_pseudo_terminal(&path) {
            Ok(Box::new(Pty::open(&path)?))
        } else {
            Ok(Box::new(Serial::open(&path, baud)?))
        }
    };
    match Reopening::new(path.to_owned(), Box::new(open)) {
        Ok(link) => Ok(Box::new(link)),
        Err(source) => Err(DeviceError::Open { path: path.to_owned(), source }),
    }
}

/// A name under /dev/serial/by-id, or any other link, stands for what it points to.
fn resolved(path: &Path) -> Result<PathBuf, DeviceError> {
    path.canonicalize().map_err(|source| DeviceError::Open { path: path.to_owned(), source })
}

fn is_pseudo_terminal(resolved: &Path) -> bool {
    resolved.starts_with(pty::DIRECTORY)
}

fn explain(choice: &DeviceChoice, process: Option<&Process>, source: SessionError) -> DeviceError {
    // A line that closes is often the first sign of a process that ends; give its end a moment to be seen. One that is
    // merely silent has been waited for long enough.
    let patience = match source {
        SessionError::Broken { source: LinkError::Disconnected, .. } => Some(Duration::from_millis(500)),
        SessionError::Silent { .. } | SessionError::TooLongAGap { .. } => Some(Duration::ZERO),
        _ => None,
    };
    let ended = process
        .zip(patience)
        .and_then(|(process, patience)| process.ended_within(patience).map(|status| (process, status)));
    match ended {
        Some((process, status)) => DeviceError::Ended {
            device: choice.to_string(),
            name: process.name(),
            id: process.id(),
            status,
            said: process.said(),
            source: Box::new(source),
        },
        None => DeviceError::Session { device: choice.to_string(), source },
    }
}

/// A number for a session that no earlier session on this machine had, for all practical purposes.
#[must_use]
pub fn session_number() -> u32 {
    let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    (now.as_nanos() as u32) ^ std::process::id().rotate_left(16)
}
