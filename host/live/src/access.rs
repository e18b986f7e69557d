//! Who may read a run and stop it.
//!
//! Without a token the server answers on loopback only, and only requests whose `Host` is a name of loopback: a foreign
//! page that points its own host name at 127.0.0.1 (DNS rebinding) sends that name. With a token every request that
//! shows or stops a run has to carry it. A request of a page has an `Origin`, and that has to be the server itself.

use std::net::{IpAddr, Ipv4Addr, SocketAddr};

use lashloop_protocol::hex::Hex;
use subtle::ConstantTimeEq;

/// Shortest token of the user, in characters.
const MIN_TOKEN: usize = 16;
const RANDOM_BYTES: usize = 16;

/// Why an address or a token is refused.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum AccessError {
    /// Not an address.
    #[error("{0:?} isn't an address: give PORT, IP or IP:PORT, such as 127.0.0.1:8080")]
    Address(String),
    /// Others could read and stop the run.
    #[error("{0} can be reached from other machines; add --live-token, or choose an address of loopback")]
    Open(SocketAddr),
    /// A token that can be guessed, or that a URL can't carry.
    #[error("the token has {0} characters; it must have at least {MIN_TOKEN} of A-Z a-z 0-9 _ -")]
    Token(usize),
    /// No random numbers.
    #[error("the system gives no random token: {0}")]
    Random(String),
}

/// Parses `PORT`, `IP`, `IP:PORT` or `localhost[:PORT]`; port 0 is any free one.
///
/// # Errors
/// The text is none of these.
pub fn address(text: &str) -> Result<SocketAddr, AccessError> {
    let loopback = IpAddr::from(Ipv4Addr::LOCALHOST);
    let (name, port) = text.rsplit_once(':').map_or((text, None), |(name, port)| (name, Some(port)));
    if name == "localhost" {
        let port = port.map_or(Ok(0), str::parse::<u16>);
        return port
            .map(|port| SocketAddr::new(loopback, port))
            .map_err(|_| AccessError::Address(text.to_owned()));
    }
    let socket = text.parse::<SocketAddr>().ok();
    let host = || text.parse::<IpAddr>().ok().map(|ip| SocketAddr::new(ip, 0));
    let port = || text.parse::<u16>().ok().map(|port| SocketAddr::new(loopback, port));
    socket.or_else(host).or_else(port).ok_or_else(|| AccessError::Address(text.to_owned()))
}

/// The secret of one run.
#[derive(Clone)]
pub struct Token(String);

impl Token {
    /// A token of the user.
    ///
    /// # Errors
    /// It is short, or has characters that need escaping in a URL.
    pub fn new(text: &str) -> Result<Self, AccessError> {
        let is_plain = text.bytes().all(|byte| byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'-'));
        if text.len() < MIN_TOKEN || !is_plain {
            return Err(AccessError::Token(text.chars().count()));
        }
        Ok(Self(text.to_owned()))
    }

    /// A token of 128 random bits.
    ///
    /// # Errors
    /// The system has no random numbers.
    pub fn random() -> Result<Self, AccessError> {
        let mut bytes = [0_u8; RANDOM_BYTES];
        getrandom::fill(&mut bytes).map_err(|error| AccessError::Random(error.to_string()))?;
        Ok(Self(Hex(&bytes).to_string()))
    }

    pub(super) fn text(&self) -> &str {
        &self.0
    }

    /// In a time that depends on no character.
    fn equals(&self, other: &str) -> bool {
        self.0.as_bytes().ct_eq(other.as_bytes()).into()
    }
}

/// The rule of one server.
pub(super) struct Access {
    token: Option<Token>,
}

/// Why a request is refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Denied {
    Host,
    Origin,
    Token,
}

impl Denied {
    pub(super) fn reason(self) -> &'static str {
        match self {
            Self::Host => "this host name is not one of loopback; use the URL that the bench has printed",
            Self::Origin => {
                "a page of another origin can't read or stop a run; with --live-token it can read, as Foxglove does"
            }
            Self::Token => "the token is missing or wrong; use the URL that the bench has printed",
        }
    }
}

impl Access {
    /// # Errors
    /// The address can be reached from elsewhere, and there is no token.
    pub(super) fn new(address: SocketAddr, token: Option<Token>) -> Result<Self, AccessError> {
        if token.is_none() && !address.ip().is_loopback() {
            return Err(AccessError::Open(address));
        }
        Ok(Self { token })
    }

    /// Checks where a request comes from.
    pub(super) fn check_source(&self, host: Option<&str>, origin: Option<&str>) -> Result<(), Denied> {
        let host = self.check_host(host)?;
        match origin {
            // A program that isn't a browser.
            None => Ok(()),
            Some(origin) if origin.strip_prefix("http://") == Some(host) => Ok(()),
            Some(_) => Err(Denied::Origin),
        }
    }

    /// Checks where a client that only watches comes from. With the token it may be a page of another origin, as Foxglove
    /// and Lichtblick are.
    pub(super) fn check_client(
        &self,
        host: Option<&str>,
        origin: Option<&str>,
        query: Option<&str>,
    ) -> Result<(), Denied> {
        if self.token.is_none() {
            return self.check_source(host, origin);
        }
        self.check_host(host)?;
        self.check_token(query)
    }

    fn check_host<'a>(&self, host: Option<&'a str>) -> Result<&'a str, Denied> {
        let host = host.ok_or(Denied::Host)?;
        // A token of 128 bits is unknown to a foreign page under any name.
        if self.token.is_none() && !is_loopback(host) { Err(Denied::Host) } else { Ok(host) }
    }

    /// Checks the token in the query of a request.
    pub(super) fn check_token(&self, query: Option<&str>) -> Result<(), Denied> {
        let Some(token) = &self.token else { return Ok(()) };
        let given = query.into_iter().flat_map(|query| query.split('&'));
        let mut given = given.filter_map(|pair| pair.strip_prefix("token="));
        if given.any(|given| token.equals(given)) { Ok(()) } else { Err(Denied::Token) }
    }
}

/// Whether a `Host`, with or without a port, is a name or an address of loopback. The port may be that of a tunnel.
fn is_loopback(host: &str) -> bool {
    let (name, port) = match host.strip_prefix('[').and_then(|rest| rest.split_once(']')) {
        Some((name, "")) => (name, "0"),
        Some((name, port)) => (name, port.strip_prefix(':').unwrap_or("none")),
        None => host.split_once(':').unwrap_or((host, "0")),
    };
    let is_name = name.eq_ignore_ascii_case("localhost");
    port.parse::<u16>().is_ok() && (is_name || name.parse::<IpAddr>().is_ok_and(|ip| ip.is_loopback()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn address_is_a_port_an_ip_or_both() {
        let shown = |text| address(text).map(|address| address.to_string());
        assert_eq!(shown("8080"), Ok("127.0.0.1:8080".to_owned()));
        assert_eq!(shown("0.0.0.0"), Ok("0.0.0.0:0".to_owned()));
        assert_eq!(shown("[::1]:80"), Ok("[::1]:80".to_owned()));
        assert_eq!(shown("localhost:81"), Ok("127.0.0.1:81".to_owned()));
        assert_eq!(shown("localhost"), Ok("127.0.0.1:0".to_owned()));
        // `localhost0` was 127.0.0.10.
        for text in ["scenario.toml", "localhost0", "localhost.5:80", "localhost:", "localhost:80:1", ""] {
            assert_eq!(shown(text), Err(AccessError::Address(text.to_owned())));
        }
    }

    #[test]
    fn only_loopback_needs_no_token() {
        let open = address("0.0.0.0:80").expect("an address");
        assert_eq!(Access::new(open, None).err(), Some(AccessError::Open(open)));
        assert!(Access::new(open, Some(Token::random().expect("a token"))).is_ok());
        assert!(Access::new(address("[::1]:80").expect("an address"), None).is_ok());
    }

    #[test]
    fn requests_of_foreign_hosts_and_origins_are_refused() {
        fn check(host: Option<&str>, origin: Option<&str>) -> Option<Denied> {
            Access { token: None }.check_source(host, origin).err()
        }
        for host in ["127.0.0.1:8080", "localhost:9000", "LOCALHOST", "[::1]:80", "127.1.2.3"] {
            assert_eq!(check(Some(host), None), None, "{host}");
            let origin = format!("http://{host}");
            assert_eq!(check(Some(host), Some(&origin)), None, "{origin}");
        }
        for host in [
            "evil.example:8080",
            "127.0.0.1.evil.example",
            "localhost.evil:80",
            "10.0.0.1:80",
            "[::1]x",
            "localhost:1:2",
        ] {
            assert_eq!(check(Some(host), None), Some(Denied::Host), "{host}");
        }
        assert_eq!(check(None, None), Some(Denied::Host));
        for origin in ["http://evil.example", "http://localhost:3000", "https://localhost:80", "null", ""] {
            assert_eq!(check(Some("localhost:80"), Some(origin)), Some(Denied::Origin), "{origin}");
        }
    }

    #[test]
    fn a_token_is_required_whole() {
        let token = Token::new("0123456789abcdef").expect("a token");
        let access = Access { token: Some(token) };
        assert_eq!(access.check_token(Some("x=1&token=0123456789abcdef")), Ok(()));
        for query in
            [None, Some(""), Some("token="), Some("token=0123456789abcde"), Some("atoken=0123456789abcdef")]
        {
            assert_eq!(access.check_token(query), Err(Denied::Token), "{query:?}");
        }
        assert_eq!(access.check_source(Some("bench-pc:80"), Some("http://bench-pc:80")), Ok(()));
        assert_eq!(access.check_source(Some("bench-pc:80"), Some("http://evil")), Err(Denied::Origin));
    }

    #[test]
    fn a_page_of_another_origin_watches_with_the_token_only() {
        let access = Access { token: Some(Token::new("0123456789abcdef").expect("a token")) };
        let (host, origin) = (Some("bench-pc:80"), Some("https://app.foxglove.dev"));
        assert_eq!(access.check_client(host, origin, Some("token=0123456789abcdef")), Ok(()));
        assert_eq!(access.check_client(host, None, None), Err(Denied::Token));
        assert_eq!(access.check_client(None, None, Some("token=0123456789abcdef")), Err(Denied::Host));
        let open = Access { token: None };
        assert_eq!(open.check_client(Some("localhost:80"), None, None), Ok(()));
        assert_eq!(open.check_client(Some("localhost:80"), origin, None), Err(Denied::Origin));
        assert_eq!(open.check_client(Some("evil.example:80"), None, None), Err(Denied::Host));
    }

    #[test]
    fn tokens_are_random_and_long() {
        let [one, other] = [(); 2].map(|()| Token::random().expect("a token"));
        assert!(one.text().len() == 2 * RANDOM_BYTES && one.text() != other.text());
        for text in ["short", "with a space and more", "percent%20percent%20"] {
            assert!(matches!(Token::new(text), Err(AccessError::Token(_))), "{text}");
        }
    }
}
