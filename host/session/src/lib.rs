//! A session with a drive: handshake, parameters, commands, and the exchange of a sample for a torque.
//!
//! | module | holds |
//! |---|---|
//! | `client` | [`Session`] |
//! | `commands` | reset, start, stop |
//! | `exchange` | a sample for a torque: [`Exchange`] |
//! | `bench_reports` | bench mode: a reference, and the reports of the drive's own steps: [`BenchReport`] |
//! | `parameter_access` | a parameter by its name |
//! | `oddities` | what contradicts itself in a drive's description |
//! | `subscribe` | the signals that telemetry carries |
//! | `capture`, `capture_request` | the signals that the drive captures around an event: [`CaptureRequest`], [`CapturedRows`] |
//! | [`description`] | the drive's description of itself, read |
//! | [`parameters`], [`laws`], [`signals`] | what it describes |
//! | [`request`] | a request and its answer, with retries |
//! | `refusal` | why a drive refuses a request, in words |
//! | `own_names` | the drive's own names of values that this bench doesn't know |
//! | `patience` | the time for all requests together |
//! | [`handshake`] | `Hello` and `Identity` |
//! | [`mod@line`] | messages on a link |
//! | `device_clock` | the clock of a drive on the host's time |
//! | `telemetry_count` | telemetry that is due, received and refused: [`TelemetryCount`] |
//! | [`diagnosis`] | what arrives instead of an answer |
//! | [`logs`] | texts of a drive, kept |
//! | `text` | text of a drive, made fit for a terminal |
//! | [`names`] | names in messages, and the one that was probably meant |
//!
//! A session has messages and deadlines, no plants or scenarios. Every wait ends, and every error names the side, the last
//! sample sent and the last good frame received. Deadlines are instants of the link's time, [`Link::now`](lashloop_link::Link::now).

#![forbid(unsafe_code)]
#![warn(missing_docs)]

mod at_step;
mod bench_reports;
mod capture;
mod capture_request;
mod client;
mod commands;
pub mod description;
mod device_clock;
pub mod diagnosis;
mod error;
mod exchange;
pub mod handshake;
pub mod laws;
pub mod line;
pub mod logs;
pub mod names;
mod oddities;
mod own_names;
mod parameter_access;
pub mod parameters;
mod patience;
mod refusal;
pub mod request;
pub mod signals;
mod subscribe;
mod telemetry_count;
mod text;
mod timestamps;

pub use at_step::AtStep;
pub use bench_reports::BenchReport;
pub use capture::CaptureError;
pub use capture_request::{CaptureRequest, CapturedRows};
pub use client::{Session, Traffic};
pub use description::Description;
pub use diagnosis::Diagnosis;
pub use error::{LastSeen, SessionError};
pub use exchange::Exchange;
pub use laws::{Law, LawMask};
pub use logs::LogEntry;
pub use own_names::ListedValue;
pub use parameters::{Choice, Parameter, SetError, WrittenValue};
pub use patience::PATIENCE;
pub use refusal::Reply;
pub use signals::{DriveSignal, Subscription};
pub use subscribe::SubscribeError;
pub use telemetry_count::TelemetryCount;
pub use text::{counted, is_control, printable, without_controls};
pub use timestamps::Timestamps;
