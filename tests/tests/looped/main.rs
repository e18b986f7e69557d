//! The whole loop as a user runs it: the `lashloop` program, drives on real pseudo-terminals, and faulty lines. Runs in the
//! emulator are in `emulated`.

mod battery;
mod bit_exact;
mod budget;
mod capture;
mod compared;
mod connect_errors;
mod crash_safety;
mod demo;
mod drive_loss;
mod estimates;
mod exec_drives;
mod exit_codes;
mod experiment;
mod fault_table;
mod hostile;
mod idle;
mod link_faults;
mod network_errors;
mod own_law;
mod own_plant;
mod paper;
mod paper_figures;
mod real_time;
mod reconnect;
mod retries;
mod shaft_scenarios;
mod soak;
mod speed;
mod summary;
mod tokio_client;
mod usage;
mod walks;
mod wire;
mod wire_bytes;
mod wraparound;
