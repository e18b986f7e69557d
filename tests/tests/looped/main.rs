//! The whole loop as a user meets it: the `lashloop` program, drives on real pseudo-terminals, and lines with faults.
//! No emulator; see `emulated` for that.

mod battery;
mod bench_scenarios;
mod bit_exact;
mod budget;
mod captured;
mod compared;
mod crash_safety;
mod demo;
mod endings;
mod estimates;
mod fault_table;
mod faults;
mod frames;
mod idle;
mod long;
mod lost;
mod paper;
mod paper_figures;
mod real_time;
mod reconnect;
mod refused;
mod retries;
mod soak;
mod speed;
mod summary;
mod tokio_client;
mod usage;
mod wire;
