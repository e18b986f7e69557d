//! The control laws of the drive and the plants of the host, closed in double precision and held against trajectories
//! that were computed by independent programs, against closed forms and against conservation of energy; then the same
//! laws in single precision behind encoders.

mod closed_loop;
mod listener;
mod machine;
mod open_loop;
mod paper;
mod paper_loops;
mod recorded;

mod agreement;
mod backlash;
mod backlash_inverse;
mod figures;
mod lugre;
mod order;
mod physics;
mod precision;
