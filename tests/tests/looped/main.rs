//! The whole loop as a user runs it: the `lashloop` program, drives on real pseudo-terminals, and faulty lines. Runs in the
//! emulator are in `emulated`.

#[path = "../../../host/identify/tests/identify/hidden_plants/keys.rs"]
mod hidden_plant_keys;
#[allow(dead_code, unused_imports, reason = "the tests of the estimates use more of it")]
#[path = "../../../host/identify/tests/identify/hidden_plants/mod.rs"]
mod hidden_plants;

mod battery;
mod bit_exact;
mod bode;
mod bridge;
mod budget;
mod campaign;
mod capture;
mod connect_errors;
mod crash_safety;
mod demo;
mod drive_loss;
mod estimates;
mod exec_drives;
mod exit_codes;
mod experiment;
mod fault_table;
mod first_reach;
mod fmu;
mod hostile;
mod idle;
mod interruptions;
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
mod suite;
mod summary;
mod tokio_client;
mod usage;
mod walks;
mod wall_clock;
mod wire;
mod wire_bytes;
mod wraparound;
