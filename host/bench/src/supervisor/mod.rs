//! Child processes and signals, on a thread of their own: the loop's thread waits for neither.
//!
//! | module | holds |
//! |---|---|
//! | `service` | [`Supervisor`]: the thread that starts children and receives SIGINT and SIGTERM |
//! | `find` | [`find_program`]: where a program is |
//! | `activity` | [`Watch`]: whether a child computes, waits for a core or is silent |
//! | `process` | [`Program`] and [`Process`]: what is started, and the running child |

mod activity;
mod find;
mod process;
mod service;

pub use activity::{Wait, Watch};
pub use find::find_program;
pub use process::{Process, Program};
pub use service::{SignalGuard, Supervisor, end_at_signals, is_interrupted};
