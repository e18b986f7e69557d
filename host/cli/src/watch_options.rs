//! How a run is watched: progress on the terminal, and the live page.

use std::net::SocketAddr;
use std::path::Path;
use std::time::Duration;

use clap::Args;
use lashloop_bench::run::Outcome;
use lashloop_bench::scenario::Scenario;

use super::error::CliError;
use super::monitor::Monitor;
use super::output::outln;
use super::progress::RunProgress;
use lashloop_live::{Ending, Live, LiveError, Token, address};

#[derive(Args, Default)]
pub(super) struct WatchOptions {
    /// Serve a page that shows the run while it lasts, and can stop it; Foxglove and its like watch at the same address.
    /// ADDRESS is PORT, IP or IP:PORT [default: a free port of 127.0.0.1]
    #[arg(long, value_name = "ADDRESS", num_args = 0..=1, require_equals = true, value_parser = address,
          default_missing_value = "127.0.0.1:0")]
    live: Option<SocketAddr>,

    /// Token that the page needs, part of its URL; necessary for an address that other machines reach [default: a random one]
    #[arg(long, value_name = "TOKEN", num_args = 0..=1, require_equals = true, requires = "live",
          value_parser = Token::new)]
    live_token: Option<Option<Token>>,

    /// Longest wait for a first reader of the page before the run starts, in s
    #[arg(long, value_name = "S", requires = "live", default_value_t = 0, value_parser = clap::value_parser!(u32).range(..=86_400))]
    live_wait: u32,

    /// Show no progress
    #[arg(long)]
    quiet: bool,
}

/// A run that is watched.
pub(super) struct Watch {
    live: Option<Live>,
    wait: Duration,
    quiet: bool,
}

impl WatchOptions {
    /// Starts the server of the page, if there is one, and prints its URLs.
    pub(super) fn start(&self) -> Result<Watch, CliError> {
        let token = match &self.live_token {
            None => None,
            Some(Some(token)) => Some(token.clone()),
            Some(None) => Some(Token::random().map_err(LiveError::from)?),
        };
        let live = self.live.map(|address| Live::start(address, token)).transpose()?;
        for url in live.iter().flat_map(Live::urls) {
            outln!("live        {url}");
        }
        Ok(Watch { live, wait: Duration::from_secs(self.live_wait.into()), quiet: self.quiet })
    }
}

impl Watch {
    /// Waits for the first reader of the page, if the user wants that.
    pub(super) fn wait(&self, stop_asked: impl Fn() -> bool) {
        if let Some(live) = &self.live {
            live.wait_for_reader(self.wait, stop_asked);
        }
    }

    /// The observer of the run.
    pub(super) fn monitor<'a>(&self, scenario: &'a Scenario) -> Monitor<'a> {
        let progress = (!self.quiet).then(|| RunProgress::new(scenario));
        Monitor::new(scenario, progress, self.live.as_ref().map(Live::publisher))
    }

    /// Shows the end of the run on the page. `record` is its folder.
    pub(super) fn finish(self, outcome: &Outcome, record: Option<&Path>) {
        if let Some(live) = self.live {
            live.finish(&Ending::new(outcome, record));
        }
    }
}
