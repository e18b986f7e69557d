//! What whole-system tests stand on: the `lashloop` program as a user runs it, drives on terminals, lines with faults,
//! and the records that a run leaves.
//!
//! | module | is |
//! |---|---|
//! | [`program`] | the program under test, built once |
//! | [`bench`](mod@bench) | one running `lashloop`, with a deadline |
//! | [`twin`] | `lashloop device`: a drive on a pseudo-terminal |
//! | [`python`] | the drive of the Python package |
//! | [`terminal`] | pseudo-terminals |
//! | [`fault_table`] | the table of `docs/faults.md` and its runs |
//! | [`relay`] | a line that can drop, damage, double and cut |
//! | [`records`] | `summary.json` and `trace.csv` |
//! | [`processes`] | other processes: who started whom, signals |
//! | [`loss`] | what has to be true when a drive is lost in mid-run |
//! | [`paper`] | the paper's four runs and the torque streams they are pinned to |
//! | [`wait`] | conditions with deadlines |
//! | [`optional`] | tests that need what a checkout does not have |
//!
//! Nothing here waits for a fixed time, and everything that is started ends with the test that started it.

#![forbid(unsafe_code)]

pub mod bench;
pub mod fault_table;
pub mod loss;
pub mod optional;
pub mod paper;
pub mod processes;
pub mod program;
pub mod python;
pub mod records;
pub mod relay;
pub mod terminal;
pub mod twin;
pub mod wait;

use std::path::Path;

/// The workspace: scenarios are named as a user in it would name them.
///
/// # Panics
/// The package lies elsewhere.
#[must_use]
pub fn workspace() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the package is a folder of the workspace")
}
