//! Frequency responses of a loop with a drive train, from torques and positions alone, with intervals.
//!
//! A [`Plan`] excites the loop by tones that fit a whole number of times into a window, so a spectrum needs no taper and has no
//! leakage. It repeats with other phases: what a response owes to the phases, be it quantisation, friction or the gap, scatters
//! from one realisation to the next, and the scatter gives coherence and interval of each line.
//!
//! ```text
//!        d                     u = d + U
//!        │                     ┌─────────┐
//!        ▼          u          │  plant  ├──▶ theta_e, theta_s
//!  U ──▶ + ───────────────────▶│         │         │
//!  ▲                           └─────────┘         │
//!  │                ┌─────────┐                    │
//!  └────────────────┤   law   │◀───────────────────┘
//!                   └─────────┘
//!
//!  sensitivity S = u / d      open loop L = -U / u = 1 / S - 1      plant P = theta / u
//! ```
//!
//! | module | is |
//! |---|---|
//! | [`plan`] | torques of a measurement, step by step, and its windows |
//! | `spectrum` | the tones of a window |
//! | [`response`] | responses with coherence and deviation, from the realisations |
//! | [`margins`] | crossovers, gain and phase margin, largest sensitivity |
//! | [`two_mass`] | the response of two masses on a shaft, as a drive with a hold and a sampler sees it |
//! | [`fit`] | stiffness, inertias, resonance and antiresonance of a measured plant, with intervals |
//! | [`gap`] | the stiffness that a gap leaves to a tone or to noise, by describing functions |
//! | `student` | quantiles for intervals |
//! | [`table`] | the lines as CSV |
//!
//! Nothing here reads a file, a port or a clock.

#![forbid(unsafe_code)]
#![warn(missing_docs)]

pub mod fit;
pub mod gap;
pub mod margins;
pub mod plan;
pub mod response;
mod spectrum;
mod student;
pub mod table;
pub mod two_mass;

pub use fit::{Estimate, Fit, FitError};
pub use margins::Margins;
pub use plan::{Excitation, Plan, PlanError};
pub use response::{Line, Measured, ResponseError};
pub use rustfft::num_complex::Complex;
