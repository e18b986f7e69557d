//! A session with a drive: handshake, parameters, commands, and the exchange of a sample for a torque.
//!
//! | module | holds |
//! |---|---|
//! | `client` | [`Session`] |
//! | `commands` | reset, start, stop |
//! | `exchange` | a sample for a torque: [`Exchange`] |
//! | `parameter_access` | a parameter by its name |
//! | [`parameters`] | the parameters as the drive describes them |
//! | [`request`] | a request and its answer, with retries |
//! | [`handshake`] | `Hello` and `Identity` |
//! | [`mod@line`] | messages on a link |
//!
//! A session has messages and deadlines, no plants or scenarios. Every wait ends, and every error names the side, the last
//! sample sent and the last good frame received. Deadlines are instants of the link's time, [`Link::now`](crate::link::Link::now).

mod at_step;
mod client;
mod commands;
mod error;
mod exchange;
pub mod handshake;
pub mod line;
mod logs;
mod parameter_access;
pub mod parameters;
pub mod request;

pub use at_step::AtStep;
pub use client::{Session, Traffic};
pub use error::{LastSeen, SessionError};
pub use exchange::Exchange;
pub use logs::printable;
pub use parameters::{Parameter, SetError};
