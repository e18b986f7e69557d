//! Real time: one step in every control period of the wall clock.
//!
//! The loop has a thread of its own. It wakes at absolute times, the start of the run plus whole periods, so lateness does
//! not accumulate. A torque after the end of its step is late: the last one is held, and nothing is retransmitted or made
//! up for. If the bench oversleeps whole steps, the plant continues under the held torque, the steps count as missed, and
//! the loop continues at the present step: never a burst.
//!
//! The thread neither allocates nor locks nor writes. Finished steps go through a ring to the caller's thread, which
//! measures and records them.

#[cfg(test)]
mod allocations;
mod loop_thread;
mod paced_loop;
mod pacer;
mod privileges;

pub(super) use loop_thread::{Ring, drain, run_with_drain};
pub use paced_loop::PERIOD_MARGIN;
pub(super) use paced_loop::close;
pub use privileges::{obtain, usable_cores};

pub use super::clock::RealTime;
