//! The inverse of the gap, led along a braking curve.
//!
//! | module | concept |
//! |---|---|
//! | `gains` | gains and limits to tune |
//! | `curve` | the braking curve: load velocity over distance |
//! | `load_loop` | velocity loop of the load along the curve, with a hold on arrival |
//! | `inertia_factor` | the load's inertia relative to the one that the curve tolerates, from its momentum |
//! | `winding` | the transmitted torque with the time that it takes to wind the shaft |
//! | `law` | the law |
//! | `signals` | its signals |

mod curve;
mod gains;
mod inertia_factor;
mod law;
mod load_loop;
mod signals;
#[cfg(test)]
mod tests;
mod winding;

pub use gains::BrakingCurveGains;
pub use law::{BrakingCurve, BrakingCurveSetting, LEARNT_DEVIATION_RAD};
pub use signals::BrakingCurveSignals;
