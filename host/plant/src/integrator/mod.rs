//! Fixed-step integration of a system that switches between smooth modes.
//!
//! Within a mode (one side in contact, the load sticking) the right-hand side is smooth, and Runge-Kutta of fourth order
//! keeps its order. A substep across a mode change would leave an error of first order, with any method. So the guard
//! functions of the mode are tested after each substep. If one has changed sign, event location finds the instant at which
//! it is zero, and the rest of the substep continues in the next mode.
//!
//! Two changes within one substep that cancel each other are not detected: the substep has to be short against the
//! fastest motion of the plant.
//!
//! | module | does |
//! |---|---|
//! | `hybrid` | the trait of a system with modes and guards |
//! | `runge_kutta` | one step of the classical method |
//! | `event` | locates the end of a mode within a substep |
//! | `advance` | substeps over the time for which a torque is held |

mod advance;
mod event;
mod hybrid;
mod runge_kutta;

pub use self::advance::advance;
pub use self::hybrid::HybridSystem;
pub use self::runge_kutta::{Rates, Stage, runge_kutta};
