//! A TCP connection to a drive: the bytes as they are, as ser2net's raw mode and an emulator's `-serial tcp:` pass them.

use std::fmt;
use std::io::{self, ErrorKind};
use std::net::{TcpStream, ToSocketAddrs};
use std::str::FromStr;
use std::time::{Duration, Instant};

use super::socket::Socket;

/// Time that a host may take to accept the connection.
const CONNECT_LIMIT: Duration = Duration::from_secs(3);

/// Time within which a telnet server sends its first command, on the networks of a laboratory.
const TELNET_LIMIT: Duration = Duration::from_millis(50);

/// A host and a port.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Address {
    /// Name of the host, IPv4 address, or IPv6 address without brackets.
    pub host: String,
    /// Port, from 1.
    pub port: u16,
}

impl FromStr for Address {
    type Err = String;

    /// Parses `HOST:PORT`, with an IPv6 address in brackets. `//` may precede it, as in a URL.
    fn from_str(text: &str) -> Result<Self, String> {
        let text = text.strip_prefix("//").unwrap_or(text);
        let expected = |problem: &str| {
            format!("expected HOST:PORT such as raspberrypi:4000 or [fe80::1]:4000, got {text:?}: {problem}")
        };
        let (host, port) = text.rsplit_once(':').ok_or_else(|| expected("the port is missing"))?;
        let host = match host.strip_prefix('[') {
            Some(host) => host.strip_suffix(']').ok_or_else(|| expected("a bracket is not closed"))?,
            None if host.contains(':') => return Err(expected("an IPv6 address needs brackets")),
            None => host,
        };
        if host.is_empty() {
            return Err(expected("the host is missing"));
        }
        match port.parse() {
            Ok(port) if port > 0 => Ok(Self { host: host.to_owned(), port }),
            _ => Err(expected("a port is a number from 1 to 65535")),
        }
    }
}

impl fmt::Display for Address {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { host, port } = self;
        if host.contains(':') { write!(out, "[{host}]:{port}") } else { write!(out, "{host}:{port}") }
    }
}

/// Why a host can't be reached.
#[derive(Debug, thiserror::Error)]
pub enum ConnectError {
    /// The name has no address.
    #[error("no host has the name {host} ({source}); check the spelling, or give the address in numbers")]
    UnknownHost {
        /// The name.
        host: String,
        /// Error of the resolver.
        source: io::Error,
    },
    /// The server negotiates telnet options.
    #[error(
        "the server sends telnet commands, not raw bytes: name it rfc2217:HOST:PORT, or set it to raw bytes"
    )]
    Telnet,
    /// No address of the host takes the connection.
    #[error("{}", reason(.0))]
    Refused(io::Error),
}

/// Connects to a server of raw bytes.
///
/// # Errors
/// As [`connect`], or the server begins with a telnet command. No frame begins so: its first byte is at most 64.
pub fn connect_raw(address: &Address) -> Result<Socket, ConnectError> {
    let socket = connect(address)?;
    let mut first = [0; 2];
    match socket.peek(&mut first, Instant::now() + TELNET_LIMIT) {
        Ok(2) if first[0] == 255 && first[1] >= 250 && first[1] < 255 => Err(ConnectError::Telnet),
        // The session reports a line that is closed.
        _ => Ok(socket),
    }
}

/// Connects without Nagle's delay.
///
/// # Errors
/// The host is unknown, or none of its addresses accepts the connection within 3 s.
pub fn connect(address: &Address) -> Result<Socket, ConnectError> {
    let unknown = |source| ConnectError::UnknownHost { host: address.host.clone(), source };
    let resolved = (address.host.as_str(), address.port).to_socket_addrs().map_err(unknown)?;
    let mut last = io::Error::new(ErrorKind::NotFound, "the name has no address");
    for one in resolved {
        match TcpStream::connect_timeout(&one, CONNECT_LIMIT) {
            Ok(stream) => {
                let socket = stream.set_nodelay(true).and_then(|()| Socket::new(stream));
                return socket.map_err(ConnectError::Refused);
            }
            Err(error) => last = error,
        }
    }
    Err(ConnectError::Refused(last))
}

fn reason(source: &io::Error) -> String {
    match source.kind() {
        ErrorKind::ConnectionRefused => {
            "connection refused; does the server run, and is this its port?".to_owned()
        }
        ErrorKind::TimedOut => format!(
            "no answer within {} s; is the host switched on, and does a firewall block the port?",
            CONNECT_LIMIT.as_secs()
        ),
        ErrorKind::HostUnreachable | ErrorKind::NetworkUnreachable => {
            format!("{source}; is this machine on the host's network?")
        }
        _ => source.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_are_displayed_as_they_are_given() {
        for text in ["localhost:4000", "192.0.2.1:1", "[::1]:65535", "[fe80::1%eth0]:4000"] {
            assert_eq!(text.parse::<Address>().unwrap().to_string(), text);
        }
        assert_eq!("//[::1]:7".parse::<Address>().unwrap().host, "::1");
    }

    #[test]
    fn an_incomplete_address_is_refused_with_its_problem() {
        for (text, problem) in [
            ("", "the port is missing"),
            ("host", "the port is missing"),
            (":4000", "the host is missing"),
            ("[]:4000", "the host is missing"),
            ("host:", "a port is a number"),
            ("host:0", "a port is a number"),
            ("host:65536", "a port is a number"),
            ("::1:4000", "needs brackets"),
            ("[::1:4000", "is not closed"),
        ] {
            let error = text.parse::<Address>().unwrap_err();
            assert!(error.contains(problem), "{text:?}: {error}");
        }
    }
}
