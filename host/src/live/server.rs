//! The server of one run, on a thread of its own.

use std::io;
use std::net::{SocketAddr, TcpListener};
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use axum::Router;
use axum::extract::ws::WebSocketUpgrade;
use axum::extract::{FromRequestParts, State};
use axum::http::header::{
    CACHE_CONTROL, CONTENT_SECURITY_POLICY, CONTENT_TYPE, HOST, ORIGIN, REFERRER_POLICY,
};
use axum::http::request::Parts;
use axum::http::{HeaderName, StatusCode};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use lashloop_report::page::assets;
use tokio::sync::oneshot;

use super::access::{Access, AccessError, Denied, Token};
use super::feed::Feed;
use super::publisher::{Publisher, json};
use super::reader;
use super::status::Ending;

/// Time for the readers to take the end of a run.
const FAREWELL: Duration = Duration::from_secs(1);
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
    url: String,
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
        let listener = TcpListener::bind(address).map_err(bind)?;
        listener.set_nonblocking(true).map_err(bind)?;
        let bound = listener.local_addr().map_err(bind)?;
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().map_err(bind)?;
        let feed = Arc::new(Feed::new());
        let (stop, stopped) = oneshot::channel();
        let site = Arc::new(Site { access, feed: Arc::clone(&feed) });
        let work = move || runtime.block_on(serve(listener, site, stopped));
        let thread = std::thread::Builder::new().name("live".to_owned()).spawn(work).map_err(bind)?;
        let url = format!("http://{bound}/{query}");
        Ok(Self { feed, url, stop: Some(stop), thread: Some(thread) })
    }

    /// The URL of the page, with the token.
    #[must_use]
    pub fn url(&self) -> &str {
        &self.url
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

    /// Sends the end to every reader and ends the server. A reader that takes nothing holds it up for a second at most.
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

/// What every request needs.
struct Site {
    access: Access,
    feed: Arc<Feed>,
}

async fn serve(listener: TcpListener, site: Arc<Site>, stopped: oneshot::Receiver<()>) {
    // A listener that is bound and not blocking fails only without a runtime.
    let Ok(listener) = tokio::net::TcpListener::from_std(listener) else { return };
    let mut readers = site.feed.readers();
    let router = Router::new()
        .route("/", get(page))
        .route("/live.js", get(async |_: Permitted| asset("text/javascript; charset=utf-8", SCRIPT)))
        .route("/live.css", get(async |_: Permitted| asset("text/css; charset=utf-8", STYLE)))
        .route("/feed", get(watch))
        .with_state(site);
    tokio::select! {
        _ = axum::serve(listener, router).into_future() => {}
        _ = stopped => {
            let _ = tokio::time::timeout(FAREWELL, readers.wait_for(|readers| *readers == 0)).await;
        }
    }
}

async fn page(_: Authorised) -> Response {
    asset("text/html; charset=utf-8", &[include_str!("page/live.html")])
}

async fn watch(_: Authorised, State(site): State<Arc<Site>>, upgrade: WebSocketUpgrade) -> Response {
    let feed = Arc::clone(&site.feed);
    reader::limited(upgrade).on_upgrade(async move |socket| reader::serve(socket, &feed).await)
}

/// The page loads nothing from elsewhere, and its URL, which may have a token, goes nowhere.
const HEADERS: [(HeaderName, &str); 3] = [
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
        // A header that isn't text is none that a browser sends.
        let header = |name| parts.headers.get(name).map(|value| value.to_str().unwrap_or("\u{0}"));
        site.access.check_source(header(HOST), header(ORIGIN)).map(|()| Self)
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
