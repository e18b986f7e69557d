//! The control laws of the drive and the plants of the host in one loop.
//!
//! In double precision the loops are compared with trajectories of independent programs, with closed forms and with
//! conservation of energy; in single precision they read encoders.

mod both_precisions;
mod closed_loop;
mod drive_train;
mod golden_pd;
mod law;
mod open_loop;
mod paper;
mod paper_loops;
mod pd_trace;
mod recorded;
mod trajectory;

mod agreement;
mod backlash_inverse;
mod backlash_shaft;
mod braking_curve;
mod convergence;
mod lugre;
mod paper_numbers;
mod paper_plants;
mod single_precision;
