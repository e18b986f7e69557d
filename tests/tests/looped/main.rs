//! The whole loop as a user meets it: the `lashloop` program, drives on real pseudo-terminals, and lines with faults.
//! No emulator; see `emulated` for that.

mod battery;
mod beyond;
mod bits;
mod budget;
mod captured;
mod compared;
mod demo;
mod endings;
mod estimates;
mod fault_table;
mod faults;
mod framed;
mod frames;
mod idle;
mod long;
mod lost;
mod paper;
mod paper_figures;
mod real_time;
mod refused;
mod repeated;
mod resumed;
mod soak;
mod speed;
mod summary;
mod surviving;
mod usage;
mod wire;
