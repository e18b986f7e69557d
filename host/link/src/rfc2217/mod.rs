//! A serial port of another machine by RFC 2217: telnet, with an option that sets the port. ser2net, pyserial's server and
//! most terminal servers have it.
//!
//! [`Rfc2217`] is a middleware around a TCP connection. On opening it negotiates 8-bit data in both directions and the
//! port's settings, and waits until the server has confirmed them. Then data passes with every 0xff doubled.
//!
//! | module | holds |
//! |---|---|
//! | `telnet` | commands between the bytes of data |
//! | `com_port` | the settings of the port |

mod com_port;
mod telnet;

use std::collections::VecDeque;
use std::io::Read as _;
use std::time::{Duration, Instant};

pub use com_port::Setting;

use self::com_port::{COM_PORT, Report};
use self::telnet::{Command, Parser, Verb, escape};
use super::error::WRITE_LIMIT;
use super::{Link, LinkError};

/// Time that a server may take for the negotiation.
const NEGOTIATION_LIMIT: Duration = Duration::from_secs(3);
/// Time that a server may take to empty its buffers.
const PURGE_LIMIT: Duration = Duration::from_millis(500);

/// 8-bit data: without this option a carriage return is followed by another byte.
const BINARY: u8 = 0;
const SUPPRESS_GO_AHEAD: u8 = 3;
/// What the bench does and lets the server do.
const OPTIONS: [u8; 3] = [BINARY, SUPPRESS_GO_AHEAD, COM_PORT];
/// Places in [`OPTIONS`].
const BINARY_AT: usize = 0;
const COM_PORT_AT: usize = 2;

/// Why a server can't serve a port to the bench.
#[derive(Debug, thiserror::Error)]
pub enum NegotiationError {
    /// No telnet command arrived.
    #[error(
        "the server sends no telnet command, so it has no RFC 2217: name a server of raw bytes tcp:HOST:PORT, or enable \
         RFC 2217 there (ser2net: telnet(rfc2217))"
    )]
    NotTelnet,
    /// The server has telnet without the option.
    #[error("the server refuses RFC 2217 (telnet option 44): enable it there (ser2net: telnet(rfc2217))")]
    NotOffered,
    /// Data would pass as text.
    #[error(
        "the server refuses 8-bit data (telnet option 0, BINARY), so it alters every carriage return: allow it there"
    )]
    NotBinary,
    /// A setting was not confirmed.
    #[error("the server did not confirm the {} within {} s", .0.name(), NEGOTIATION_LIMIT.as_secs())]
    Unconfirmed(Setting),
    /// A setting was confirmed with another value.
    #[error(
        "the server set the {} to {got}, not to {}: choose one that its port supports, on both sides",
        wanted.name(),
        wanted.value
    )]
    Differs {
        /// Setting requested.
        wanted: Setting,
        /// Value in force.
        got: u32,
    },
    /// The connection failed.
    #[error("{0} during the negotiation; does another client use the port?")]
    Link(#[from] LinkError),
}

/// One side of an option.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
enum Side {
    /// Offered or requested by the bench, without an answer yet.
    #[default]
    Pending,
    On,
    Off,
}

/// The state of one option.
#[derive(Debug, Clone, Copy, Default)]
struct OptionState {
    ours: Side,
    theirs: Side,
}

impl OptionState {
    fn is_pending(self) -> bool {
        self.ours == Side::Pending || self.theirs == Side::Pending
    }

    fn is_on(self) -> bool {
        self.ours == Side::On && self.theirs == Side::On
    }
}

/// Reads after a deadline that may return commands without data.
const LATE_LOOKS: u32 = 100;

/// A link to a serial port behind an RFC 2217 server.
pub struct Rfc2217 {
    link: Box<dyn Link>,
    parser: Parser,
    commands: Vec<Command>,
    options: [OptionState; OPTIONS.len()],
    has_telnet: bool,
    confirmed: Vec<Setting>,
    is_purged: bool,
    /// The server takes no data at present.
    is_suspended: bool,
    /// Data that arrived while the bench waited for a command.
    arrived: VecDeque<u8>,
    outgoing: Vec<u8>,
}

impl Rfc2217 {
    /// Negotiates over a new connection: 8 data bits, no parity, one stop bit, no flow control at `baud` bits per second.
    ///
    /// # Errors
    /// The server has no RFC 2217, or does not set the port as requested.
    pub fn open(link: Box<dyn Link>, baud: u32) -> Result<Self, NegotiationError> {
        let mut port = Self {
            link,
            parser: Parser::default(),
            commands: Vec::new(),
            options: Default::default(),
            has_telnet: false,
            confirmed: Vec::new(),
            is_purged: false,
            is_suspended: false,
            arrived: VecDeque::new(),
            outgoing: Vec::new(),
        };
        let deadline = port.link.now() + NEGOTIATION_LIMIT;
        for option in OPTIONS {
            port.queue(&Command::Negotiation(Verb::Will, option));
            port.queue(&Command::Negotiation(Verb::Do, option));
        }
        port.flush()?;
        port.work(deadline, |port| port.com_port() != Side::Pending)?;
        match port.com_port() {
            Side::On => {}
            Side::Off => return Err(NegotiationError::NotOffered),
            Side::Pending if port.has_telnet => return Err(NegotiationError::NotOffered),
            Side::Pending => return Err(NegotiationError::NotTelnet),
        }
        port.work(deadline, |port| !port.options[BINARY_AT].is_pending())?;
        if !port.options[BINARY_AT].is_on() {
            return Err(NegotiationError::NotBinary);
        }
        let settings = Setting::all(baud);
        for setting in settings {
            port.queue(&setting.request());
        }
        for command in com_port::unconfirmed() {
            port.queue(&command);
        }
        port.flush()?;
        port.work(deadline, |port| settings.iter().all(|setting| port.in_force(*setting).is_some()))?;
        for wanted in settings {
            match port.in_force(wanted) {
                None => return Err(NegotiationError::Unconfirmed(wanted)),
                Some(got) if got != wanted.value => return Err(NegotiationError::Differs { wanted, got }),
                Some(_) => {}
            }
        }
        port.arrived.clear();
        Ok(port)
    }

    /// Whether the server has the option. A client offers it; some servers offer it as well.
    fn com_port(&self) -> Side {
        let OptionState { ours, theirs } = self.options[COM_PORT_AT];
        match (ours, theirs) {
            (Side::On, _) | (_, Side::On) => Side::On,
            (Side::Off, _) => Side::Off,
            (Side::Pending, _) => Side::Pending,
        }
    }

    /// The value that the server reported last for a setting of this kind.
    fn in_force(&self, wanted: Setting) -> Option<u32> {
        let last = self.confirmed.iter().rev().find(|setting| setting.command == wanted.command);
        last.map(|setting| setting.value)
    }

    fn queue(&mut self, command: &Command) {
        command.append_to(&mut self.outgoing);
    }

    fn flush(&mut self) -> Result<(), LinkError> {
        if self.outgoing.is_empty() {
            return Ok(());
        }
        let sent = self.link.send(&self.outgoing);
        // After an error too: some of the bytes may have been sent, and the next frame must not follow them.
        self.outgoing.clear();
        sent
    }

    /// Receives until `done` or the deadline. Data is kept.
    fn work(&mut self, deadline: Instant, done: impl Fn(&Self) -> bool) -> Result<(), LinkError> {
        let mut buffer = [0; 256];
        while !done(self) {
            match self.receive_data(&mut buffer, deadline)? {
                None => return Ok(()),
                Some(count) => self.arrived.extend(&buffer[..count]),
            }
            // Bytes that keep arriving do not extend the wait.
            if self.link.now() >= deadline {
                return Ok(());
            }
        }
        Ok(())
    }

    /// Receives once, handles the commands and returns the number of data bytes in `buffer`; `None` if nothing arrived
    /// until the deadline.
    fn receive_data(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<Option<usize>, LinkError> {
        let count = self.link.receive(buffer, deadline)?;
        let data = self.parser.take(&mut buffer[..count], &mut self.commands);
        if !self.commands.is_empty() {
            for command in std::mem::take(&mut self.commands) {
                self.handle(&command);
            }
            self.flush()?;
        }
        Ok((count > 0).then_some(data))
    }

    fn handle(&mut self, command: &Command) {
        self.has_telnet = true;
        match command {
            Command::Negotiation(verb, option) => {
                if let Some(reply) = self.negotiated(*verb, *option) {
                    self.queue(&Command::Negotiation(reply, *option));
                }
            }
            Command::Subnegotiation(content) => match Report::of(content) {
                Some(Report::Confirmed(setting)) => self.confirmed.push(setting),
                Some(Report::Purged) => self.is_purged = true,
                Some(Report::Suspended(is_suspended)) => self.is_suspended = is_suspended,
                None => {}
            },
        }
        // A server may report a setting whenever it likes; the last report of each kind counts.
        if self.confirmed.len() > 64 {
            self.confirmed.drain(..32);
        }
    }

    /// Notes what the server does or wants, and gives the reply, if one is due. An answer to our own offer or request gets
    /// none, so two ends never answer each other endlessly (RFC 1143).
    fn negotiated(&mut self, verb: Verb, option: u8) -> Option<Verb> {
        let (yes, no) = match verb {
            Verb::Do | Verb::Dont => (Verb::Will, Verb::Wont),
            Verb::Will | Verb::Wont => (Verb::Do, Verb::Dont),
        };
        let is_wanted = matches!(verb, Verb::Do | Verb::Will);
        let Some(at) = OPTIONS.iter().position(|known| *known == option) else {
            return is_wanted.then_some(no);
        };
        let state = &mut self.options[at];
        let side = match verb {
            Verb::Do | Verb::Dont => &mut state.ours,
            Verb::Will | Verb::Wont => &mut state.theirs,
        };
        let before = std::mem::replace(side, if is_wanted { Side::On } else { Side::Off });
        match (before, is_wanted) {
            (Side::Off, true) => Some(yes),
            (Side::On, false) => Some(no),
            _ => None,
        }
    }
}

impl Link for Rfc2217 {
    fn inner(&mut self) -> Option<&mut dyn Link> {
        Some(self.link.as_mut())
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        if self.is_suspended {
            let give_up = self.link.now() + WRITE_LIMIT;
            self.work(give_up, |port| !port.is_suspended)?;
            if self.is_suspended {
                return Err(LinkError::Stuck);
            }
        }
        escape(bytes, &mut self.outgoing);
        self.flush()
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
        if !self.arrived.is_empty() {
            // Otherwise it reads up to the place where the ring wraps.
            self.arrived.make_contiguous();
            return Ok(self.arrived.read(buffer).unwrap_or(0));
        }
        let mut late_looks = 0;
        loop {
            match self.receive_data(buffer, deadline)? {
                None => return Ok(0),
                // A command alone: data may wait behind it, even after the deadline, but not behind commands without end.
                Some(0) if late_looks >= LATE_LOOKS => return Ok(0),
                Some(0) => late_looks += u32::from(self.link.now() >= deadline),
                Some(count) => return Ok(count),
            }
        }
    }

    /// Empties the buffers of the server too: everything ahead of its confirmation is old.
    fn discard_input(&mut self) -> Result<(), LinkError> {
        self.is_purged = false;
        self.queue(&com_port::purge());
        self.flush()?;
        let give_up = self.link.now() + PURGE_LIMIT;
        self.work(give_up, |port| port.is_purged)?;
        self.arrived.clear();
        Ok(())
    }
}

#[cfg(test)]
mod tests;
