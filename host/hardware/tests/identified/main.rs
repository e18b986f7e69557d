//! Commissioning and identification through the program's library: runs in process, records, files, gate.

mod commissioned;
mod gated;
mod recorded;
