//! Commissioning and identification through the program's library: runs in process, records, files, gate.

mod commissioned;
mod gated;
mod hidden_machines;
#[path = "../../../identify/tests/identify/hidden_plants/keys.rs"]
mod hidden_plant_keys;
#[expect(dead_code, reason = "the coverage of the intervals has the rest")]
#[path = "../../../identify/tests/identify/hidden_plants/hidden.rs"]
mod hidden_plants;
mod recorded;
