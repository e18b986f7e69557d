//! The server of one run, on a thread of its own.

use std::io;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, UdpSocket};
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use axum::Router;
use axum::extract::ws::WebSocketUpgrade;
use axum::extract::ws::rejection::WebSocketUpgradeRejection;
use axum::extract::{FromRequestParts, State};
use axum::http::header::{
    CACHE_CONTROL, CONNECTION, CONTENT_SECURITY_POLICY, CONTENT_TYPE, HOST, ORIGIN, REFERRER_POLICY,
};
use axum::http::request::Parts;
use axum::http::{HeaderName, StatusCode};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use lashloop_report::page::assets;
use tokio::net::{TcpListener, TcpSocket};
use tokio::sync::oneshot;

use super::access::{Access, AccessError, Denied, Token};
use super::client;
use super::connections::Connections;
use super::feed::Feed;
use super::foxglove::SUBPROTOCOLS;
use super::publisher::{Publisher, json};
use super::reader;
use super::status::Ending;

/// Time for the readers to take more of a run that has ended, and to take all of it.
const FAREWELL: Duration = Duration::from_secs(1);
const LONGEST_FAREWELL: Duration = Duration::from_secs(20);
/// What the system keeps for a reader that takes nothing: a few messages. A larger buffer would show it old samples.
const SEND_BUFFER_BYTES: u32 = 64 << 10;
/// Connections that may wait to be accepted.
const BACKLOG: u32 = 128;
/// Time between two looks for a first reader.
const LOOK: Duration = Duration::from_millis(20);

/// Why a run can't be watched.
#[derive(Debug, thiserror::Error)]
pub enum LiveError {
    /// The address or the token.
    #[error(transparent)]
    Access(#[from] AccessError),
    /// The address is in use, or not one of this machine.
    #[error("{address} can't be used: {source}; choose another address with --live=ADDRESS")]
    Bind {
        /// The address.
        address: SocketAddr,
        /// The system's reason.
        source: io::Error,
    },
}

/// The page of a run: its server, which ends with this value.
pub struct Live {
    feed: Arc<Feed>,
    address: SocketAddr,
    urls: Vec<String>,
    stop: Option<oneshot::Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Live {
    /// Starts the server. Port 0 is any free one.
    ///
    /// # Errors
    /// The address can be reached from elsewhere and there is no token, or it can't be used.
    pub fn start(address: SocketAddr, token: Option<Token>) -> Result<Self, LiveError> {
        let bind = |source| LiveError::Bind { address, source };
        let query = token.as_ref().map_or(String::new(), |token| format!("?token={}", token.text()));
        let access = Access::new(address, token)?;
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().map_err(bind)?;
        let listener = {
            let _runtime = runtime.enter();
            listen(address).map_err(bind)?
        };
        let bound = listener.local_addr().map_err(bind)?;
        let feed = Arc::new(Feed::new());
        let (stop, stopped) = oneshot::channel();
        let site = Arc::new(Site { access, feed: Arc::clone(&feed) });
        let work = move || runtime.block_on(serve(listener, site, stopped));
        let thread = std::thread::Builder::new().name("live".to_owned()).spawn(work).map_err(bind)?;
        tracing::debug!(thread = "live", %bound, "started");
        let urls = reachable(bound).map(|address| format!("http://{address}/{query}")).collect();
        Ok(Self { feed, address: bound, urls, stop: Some(stop), thread: Some(thread) })
    }

    /// The address with its port.
    #[must_use]
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// The URLs of the page, with the token: of a server on all addresses that of the network first.
    #[must_use]
    pub fn urls(&self) -> &[String] {
        &self.urls
    }

    /// What the run publishes with.
    #[must_use]
    pub fn publisher(&self) -> Publisher {
        Publisher::new(Arc::clone(&self.feed))
    }

    /// Waits for a first reader, at most for `limit` or until `stop_asked`.
    pub fn wait_for_reader(&self, limit: Duration, stop_asked: impl Fn() -> bool) {
        let began = Instant::now();
        while !self.feed.was_visited() && began.elapsed() < limit && !stop_asked() {
            std::thread::sleep(LOOK);
        }
    }

    /// Sends the end to every reader and ends the server. A reader that takes nothing holds it up for a second, a slow one for
    /// 20 s at most.
    pub fn finish(mut self, ending: &Ending) {
        self.feed.end(json(ending));
        self.shut_down();
    }

    fn shut_down(&mut self) {
        if let Some(stop) = self.stop.take() {
            // The receiver is closed only once the thread has ended.
            let _ = stop.send(());
        }
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

impl Drop for Live {
    /// Ends the server of a run that failed.
    fn drop(&mut self) {
        if self.thread.is_some() {
            self.feed.end(r#"{"kind":"failed"}"#.into());
            self.shut_down();
        }
    }
}

fn listen(address: SocketAddr) -> io::Result<TcpListener> {
    let socket = if address.is_ipv4() { TcpSocket::new_v4() } else { TcpSocket::new_v6() }?;
    // A port of a run that has just ended is free.
    socket.set_reuseaddr(true)?;
    socket.set_send_buffer_size(SEND_BUFFER_BYTES)?;
    socket.bind(address)?;
    socket.listen(BACKLOG)
}

/// Addresses that a browser can open; 0.0.0.0 and [::] are none.
fn reachable(bound: SocketAddr) -> impl Iterator<Item = SocketAddr> {
    let ips = match bound.ip() {
        IpAddr::V4(ip) if ip.is_unspecified() => [own_address(ip.into()), Some(Ipv4Addr::LOCALHOST.into())],
        IpAddr::V6(ip) if ip.is_unspecified() => {
            let network = own_address(ip.into()).or_else(|| own_address(Ipv4Addr::UNSPECIFIED.into()));
            [network, Some(Ipv6Addr::LOCALHOST.into())]
        }
        ip => [Some(ip), None],
    };
    ips.into_iter().flatten().map(move |ip| SocketAddr::new(ip, bound.port()))
}

/// The address of this machine on the way to others; `None` without a route. `any` chooses the family.
fn own_address(any: IpAddr) -> Option<IpAddr> {
    // An address of documentation. Connecting a datagram socket chooses the route and sends nothing.
    let elsewhere = match any {
        IpAddr::V4(_) => IpAddr::from(Ipv4Addr::new(192, 0, 2, 1)),
        IpAddr::V6(_) => IpAddr::from(Ipv6Addr::new(0x2001, 0xdb8, 0, 0, 0, 0, 0, 1)),
    };
    let socket = UdpSocket::bind((any, 0)).ok()?;
    socket.connect((elsewhere, 9)).ok()?;
    Some(socket.local_addr().ok()?.ip())
}

/// What every request needs.
struct Site {
    access: Access,
    feed: Arc<Feed>,
}

async fn serve(listener: TcpListener, site: Arc<Site>, stopped: oneshot::Receiver<()>) {
    let (mut readers, feed) = (site.feed.readers(), Arc::clone(&site.feed));
    let router = Router::new()
        .route("/", get(root))
        .route("/live.js", get(async |_: Permitted| asset("text/javascript; charset=utf-8", SCRIPT)))
        .route("/live.css", get(async |_: Permitted| asset("text/css; charset=utf-8", STYLE)))
        .route("/feed", get(watch))
        .with_state(site);
    tokio::select! {
        _ = axum::serve(Connections::new(listener), router).into_future() => {}
        _ = stopped => {
            let ended = Instant::now();
            let mut taken = None;
            // A slow reader gets the rest, and one that takes nothing holds up the end for a second.
            while taken != Some(feed.taken()) && ended.elapsed() < LONGEST_FAREWELL {
                taken = Some(feed.taken());
                let _ = tokio::time::timeout(FAREWELL, readers.wait_for(|readers| *readers == 0)).await;
                if *readers.borrow() == 0 {
                    break;
                }
            }
        }
    }
}

/// The page, or a client of Foxglove: its users type an address without a path.
async fn root(
    upgrade: Result<WebSocketUpgrade, WebSocketUpgradeRejection>,
    browser: Result<Authorised, Denied>,
    client: Result<Watching, Denied>,
    State(site): State<Arc<Site>>,
) -> Result<Response, Denied> {
    let Ok(upgrade) = upgrade else {
        browser?;
        return Ok(asset("text/html; charset=utf-8", &[include_str!("page/live.html")]));
    };
    client?;
    let upgrade = client::limited(upgrade).protocols(SUBPROTOCOLS);
    if upgrade.selected_protocol().is_none() {
        let [preferred, other] = SUBPROTOCOLS;
        let text = format!("this websocket speaks {preferred} and {other}; the page's own feed is /feed\n");
        return Ok((StatusCode::BAD_REQUEST, HEADERS, text).into_response());
    }
    let reader = site.feed.enter();
    Ok(upgrade.on_upgrade(async move |socket| client::serve(socket, reader).await))
}

async fn watch(_: Authorised, State(site): State<Arc<Site>>, upgrade: WebSocketUpgrade) -> Response {
    let reader = site.feed.enter();
    reader::limited(upgrade).on_upgrade(async move |socket| reader::serve(socket, reader).await)
}

/// The page loads nothing from elsewhere, and its URL, which may have a token, goes nowhere.
const HEADERS: [(HeaderName, &str); 4] = [
    // An idle connection keeps others out.
    (CONNECTION, "close"),
    (CACHE_CONTROL, "no-store"),
    (REFERRER_POLICY, "no-referrer"),
    (
        CONTENT_SECURITY_POLICY,
        "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src data:; base-uri 'none'; \
         form-action 'none'; frame-ancestors 'none'",
    ),
];

/// Charts and style are those of reports.
const SCRIPT: &[&str] = &[assets::CHARTS, include_str!("page/live.js")];
const STYLE: &[&str] = &[assets::STYLE, include_str!("page/live.css")];

fn asset(content_type: &'static str, parts: &[&str]) -> Response {
    ([(CONTENT_TYPE, content_type)], HEADERS, parts.concat()).into_response()
}

impl IntoResponse for Denied {
    fn into_response(self) -> Response {
        (StatusCode::FORBIDDEN, HEADERS, format!("{}\n", self.reason())).into_response()
    }
}

/// A request from a permitted source.
struct Permitted;

impl FromRequestParts<Arc<Site>> for Permitted {
    type Rejection = Denied;

    async fn from_request_parts(parts: &mut Parts, site: &Arc<Site>) -> Result<Self, Denied> {
        let [host, origin] = source(parts);
        site.access.check_source(host, origin).map(|()| Self)
    }
}

/// Host and origin of a request.
fn source(parts: &Parts) -> [Option<&str>; 2] {
    // Browsers send text headers only.
    [HOST, ORIGIN].map(|name| parts.headers.get(name).map(|value| value.to_str().unwrap_or("\u{0}")))
}

/// A request to watch and no more.
struct Watching;

impl FromRequestParts<Arc<Site>> for Watching {
    type Rejection = Denied;

    async fn from_request_parts(parts: &mut Parts, site: &Arc<Site>) -> Result<Self, Denied> {
        let [host, origin] = source(parts);
        site.access.check_client(host, origin, parts.uri.query()).map(|()| Self)
    }
}

/// A request from a permitted source, with the token.
struct Authorised;

impl FromRequestParts<Arc<Site>> for Authorised {
    type Rejection = Denied;

    async fn from_request_parts(parts: &mut Parts, site: &Arc<Site>) -> Result<Self, Denied> {
        Permitted::from_request_parts(parts, site).await?;
        site.access.check_token(parts.uri.query()).map(|()| Self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn urls_of_all_addresses_name_one_that_a_browser_can_open() {
        for (any, loopback) in [("0.0.0.0:80", "127.0.0.1:80"), ("[::]:80", "[::1]:80")] {
            let addresses: Vec<_> = reachable(any.parse().expect("an address")).collect();
            assert!(addresses.iter().all(|it| !it.ip().is_unspecified() && it.port() == 80), "{addresses:?}");
            assert_eq!(addresses.last().map(ToString::to_string).as_deref(), Some(loopback));
        }
        let one = "192.0.2.7:81".parse().expect("an address");
        assert_eq!(reachable(one).collect::<Vec<_>>(), [one]);
    }
}
