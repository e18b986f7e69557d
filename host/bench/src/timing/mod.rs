//! The timing of a run's steps, and the report of it.
//!
//! A step is a round trip: the bench wakes, sends a sample, waits, and receives the torque. All times are wall-clock times.
//!
//! ```text
//! due    woke   asked      sent                     arrived    decoded
//!  ├──────┼───────┼──────────┼─────────────────────────┼──────────┤
//!  lateness        send        line and device, compute   receive
//! ```
//!
//! The drive reports its compute time in its answer; the rest belongs to the line and the operating systems.

mod quantiles;
mod report;
mod step_timing;

pub use quantiles::Quantiles;
pub use report::{ClockName, TimingReport, Timings};
pub use step_timing::{RoundTrip, StepOutcome, StepTiming};
