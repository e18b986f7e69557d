//! The whole loop as a user meets it: the `lashloop` program, drives on real pseudo-terminals, and lines with faults.
//! No emulator; see `emulated` for that.

mod battery;
mod beyond;
mod bits;
mod demo;
mod endings;
mod faults;
mod framed;
mod frames;
mod lost;
mod paper;
mod real_time;
mod refused;
mod speed;
mod summary;
mod usage;
