//! Identification of a drive train with backlash from periods, torques and counts alone.
//!
//! [`identify`] estimates; [`excitation`] has the motions that show all there is to see, within limits that a user
//! confirms. Neither reads a file, a port or a clock.
//!
//! The estimates are those under which the plant model `backlash-shaft` repeats the recorded counts best: nonlinear least
//! squares over whole simulations, started from estimates in stages. An encoder that counts exactly leaves residuals of
//! 0.29 counts, so the intervals are narrow where the plant is like the model, and wide where it isn't.
//!
//! | module | is |
//! |---|---|
//! | `series` | torques and counts of a motion; what is given of the instruments |
//! | `signs` | directions of the encoders, by the work of the torque |
//! | `parameters`, `prior` | the parameters as the fit varies them; what is known of them before |
//! | `cogging`, `dents` | counts of the cogging per turn; motions that begin in another of its dents |
//! | `quantity`, `errors` | a quantity with its interval; those of the errors of torque and encoders |
//! | `replay` | the torques of a motion on the plant model |
//! | `window`, `least_squares` | counts behind a smooth window; linear least squares |
//! | `free_body`, `balance`, `breakaway`, `staged` | first estimates: torques of the motor, of the load, its breakaway, all in order |
//! | `problem`, `noise`, `normal`, `fit` | nonlinear least squares: cost, worth of a residual, normal equations, steps |
//! | `identified` | quantities with intervals |
//! | `identify` | all of it in order |
//! | [`electrical`] | the motor on a bridge: its motions, and R, L, k_e and the sensor from them |
//! | [`excitation`] | motions, limits, guard, and the order of a commissioning |
//!
//! # What counts can't show
//!
//! Counts per revolution of both encoders, the scale of the torque, and the delay of the torque are given, not estimated.
//! From counts alone only the ratio of the two resolutions times the reduction ratio is observable.

#![forbid(unsafe_code)]
#![warn(missing_docs)]

mod balance;
mod breakaway;
mod cogging;
mod dents;
pub mod electrical;
mod errors;
pub mod excitation;
mod fit;
mod free_body;
mod identified;
mod identify;
mod least_squares;
mod noise;
mod normal;
mod parameters;
mod prior;
mod problem;
mod quantity;
mod replay;
mod series;
mod signs;
mod staged;
mod window;

pub use errors::{EncoderError, Source, TorqueDoubt};
pub use identified::Identified;
pub use identify::{IdentifyError, Start, identify};
pub use quantity::{CONFIDENCE, Estimate, Quantity};
pub use series::{Held, Instruments, Series, SeriesError};
pub use signs::{Direction, Directions, contradict, directions};
