//! The inverse of the gap, led along a braking curve.
//!
//! | module | concept |
//! |---|---|
//! | `tuning` | what a user states besides the mechanics |
//! | `gains` | every gain, synthesised from the machine |
//! | `curve` | the braking curve: load velocity over distance |
//! | `load_loop` | velocity loop of the load along the curve, with a hold on arrival |
//! | `hunting` | wider hold and slower loop for a load that swings through its target |
//! | `inertia_factor` | the load's inertia relative to the one that the curve tolerates, from its momentum |
//! | `winding` | the transmitted torque with the time that it takes to wind the shaft |
//! | `law` | the law |
//! | `signals` | its signals |

mod curve;
mod gains;
mod hunting;
mod inertia_factor;
mod law;
mod load_loop;
mod signals;
#[cfg(test)]
mod tests;
mod tuning;
mod winding;

pub use gains::{BrakingCurveSetting, Gains};
pub use law::BrakingCurve;
pub use signals::BrakingCurveSignals;
pub use tuning::BrakingCurveTuning;
