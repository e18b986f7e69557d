//! The control laws of the drive and the plants of the host, closed in double precision and held against trajectories
//! that were computed by independent programs, against closed forms and against conservation of energy; then the same
//! laws in single precision behind encoders.

mod bench;
mod closed_loop;
mod listener;
mod machine;
mod open_loop;
mod paper;
mod recorded;

mod agreement;
mod backlash;
mod compensating;
mod figures;
mod lugre;
mod order;
mod physics;
mod precision;
