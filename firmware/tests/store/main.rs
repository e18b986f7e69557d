//! Parameters that survive power-off, on a simulated flash whose power can be cut at any instant.

mod flash;
mod power_cuts;
mod requests;
