//! A run in a browser, and in Foxglove, while it lasts.
//!
//! ```text
//! run ─▶ Publisher ─▶ buckets ─▶ Feed: histories, status ─▶ readers, each with its place ─▶ websockets
//! ```
//!
//! | module | does |
//! |---|---|
//! | `envelope` | steps to buckets with their least and greatest values; bounded histories |
//! | `panels` | which signals the page shows together |
//! | `standing` | the expectations that are decided before the end |
//! | `status` | the state of a run as the page shows it |
//! | `feed` | what the run publishes and readers take: bounded, and the newest wins |
//! | `publisher` | the run's side of the feed |
//! | `access` | addresses, tokens, hosts and origins |
//! | `reader` | the feed as messages of a websocket |
//! | `messages` | the latest steps and events one by one, as `run.mcap` has them; bounded |
//! | `foxglove`, `client` | the protocol of Foxglove, Lichtblick and PlotJuggler; one client of it |
//! | `connections` | a bounded number of them |
//! | `server` | the server, on a thread of its own |
//!
//! The run's side never waits: it keeps its buckets while a reader copies, and a reader that is too slow skips.

#![forbid(unsafe_code)]

mod access;
mod client;
mod connections;
mod envelope;
mod feed;
mod foxglove;
mod messages;
mod panels;
mod publisher;
mod reader;
mod server;
mod standing;
mod status;

pub use access::{AccessError, Token, address};
pub use publisher::Publisher;
pub use server::{Live, LiveError};
pub use standing::{Row, SoFar, Standing};
pub use status::{Ending, Status};
