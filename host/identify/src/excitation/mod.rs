//! The motions that show an unknown drive train, in their order, each within limits.
//!
//! | motion | excites |
//! |---|---|
//! | none, then held torques if the drive train moves | whether it rests, and under which torque |
//! | ramp until the load moves, forward and backward | directions of the encoders, torque of breakaway |
//! | slow reversal, within breakaway and beyond it | gap, stiffness, friction of motor and load each way, ratio |
//! | steps within breakaway | inertia of the motor, damping of the shaft |
//! | pulses beyond breakaway, growing to a quarter of the travel | inertia, friction and viscous friction of the load, ratio |
//!
//! The first ramp moves the motor by as little as the load needs to move, before any direction is known. No motion closes
//! a loop.

mod bench;
mod held;
mod limits;
mod motions;
mod procedure;

pub use bench::{CommissioningError, DriveTrain, Made};
pub(crate) use limits::REST_S;
pub use limits::{Exceeded, Guard, Halt, Limits, Noisy, Peaks};
pub use motions::{Breakaway, PlannedMotion};
pub use procedure::{Commissioned, commission};
