//! Child processes and signals, on a thread of their own: the loop's thread waits for neither.
//!
//! | module | holds |
//! |---|---|
//! | `service` | [`Supervisor`]: the thread that starts and watches children |
//! | `process` | [`Program`] and [`Process`]: what is started, and the running child |
//! | `signals` | SIGINT and SIGTERM |

mod process;
mod service;
mod signals;

pub use process::{Process, Program};
pub use service::{SignalGuard, Supervisor};
