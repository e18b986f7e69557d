//! The metrics of a run, and statistics of its signals.
//!
//! A run has one sample per control period, with the error e = load position - reference. [`Metric`] defines each metric;
//! `docs/metrics.md` lists the definitions and is tested against them. Rise time, overshoot and settling time are those of
//! Ogata, Modern Control Engineering, 5th edition, section 5-3: 10 % to 90 % of the way, and bands of 5 % and 2 %. The steady
//! velocity error is that of section 5-8, the steady-state error under a ramp.
//!
//! A query ([`Query`]) asks for a metric or a [`Statistic`] over a window of the run. The window's samples are then the whole
//! run: its first sample is the initial error, its times count from that sample, and the last second is that of the window.
//!
//! Each estimate of the drive is compared with the truth of its own sample, and steps without telemetry contribute nothing.
//! A law that doesn't estimate but reports a disturbing torque of zero scores the root mean square of w itself, which an
//! estimator has to beat. On the paper's smooth plant the gap is four times as wide as j0; a law that identifies the actual
//! gap is far from j0 there.
//!
//! A metric without a value has a reason ([`Measured`]); a metric whose signal is absent names it. One position, reference or
//! torque that isn't finite takes the value from every metric of the run, and so does a plant that could not be integrated
//! to the end. So a run that diverged can't score well by its beginning, or by a comparison that drops NaN. A signal that
//! isn't finite takes the value from the quantities of that signal only.
//!
//! | module | is |
//! |---|---|
//! | `sample`, `signal_table` | the input: one sample, and the names of its signals |
//! | `metric` | every metric with its definition, one entry each |
//! | `query`, `statistic` | statistics of any signal, and windows |
//! | `trend` | how a value can change before the end of a run |
//! | `plan` | what is known before the run, and what it can't measure |
//! | `measurement`, `results` | from samples to values |
//! | `meter`, `channel` | the contract of a metric's computation, and what it reads |
//! | `settling`, `after_move`, `rise_time`, `overshoot` | meters of the transient |
//! | `coverage` | meter of the estimates' own deviations |
//! | `tail`, `velocity_error`, `lost_motion` | meters of the steady state |
//! | `torque` | meters of the torque |

mod after_move;
mod channel;
mod coverage;
#[cfg(test)]
mod fixture;
mod lost_motion;
mod measured;
mod measurement;
mod meter;
mod metric;
mod overshoot;
mod plan;
mod query;
mod results;
mod rise_time;
mod sample;
mod settling;
mod signal_table;
mod statistic;
mod tail;
mod torque;
mod trend;
mod velocity_error;

pub use self::measured::Measured;
pub use self::measurement::Measurement;
pub use self::metric::{Metric, SETTLED_RAD};
pub use self::plan::{Plan, RunStart, assumed_signals};
pub use self::query::{Quantity, Query, Window};
pub use self::results::Metrics;
pub use self::sample::Sample;
pub use self::signal_table::{DRIVE_PREFIX, FIXED_SIGNALS, SignalTable};
pub use self::statistic::Statistic;
pub use self::trend::Trend;
