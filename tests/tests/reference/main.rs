//! The control laws of the drive and the plants of the host, closed in double precision and held against trajectories
//! that were computed by independent programs, against closed forms and against conservation of energy.

mod closed_loop;
mod paper;
mod recorded;

mod agreement;
