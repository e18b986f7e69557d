//! Support for whole-system tests: the `lashloop` program as a user runs it, drives on terminals, faulty lines, and the
//! records of runs.
//!
//! | module | is |
//! |---|---|
//! | [`program`] | the program under test, built once; one invocation with a deadline |
//! | [`twin`] | `lashloop device`: a drive on a pseudo-terminal |
//! | [`battery`] | the output of `lashloop conformance` |
//! | [`c_drive`] | the drive in C of `examples/drive-in-c` |
//! | [`python`] | the drive of the Python package |
//! | [`terminal`] | pseudo-terminals |
//! | [`fault_table`] | the table of `docs/faults.md` and its runs |
//! | [`fmu`] | FMUs of a C file, and scenarios with them |
//! | [`elf`] | small ELF files for the Cortex-M |
//! | [`rom_loader`] | the boot loader of the chip |
//! | [`powered`] | a drive with the bytes of its line, without a program of its own |
//! | [`scripted`] | runs in real time on a clock that moves only when waited for |
//! | [`relay`] | a line that can drop, damage, duplicate and disconnect |
//! | [`records`] | the files of a run: its summary and its samples |
//! | [`processes`] | other processes: children, processor time, signals |
//! | [`loss`] | what must hold after the loss of a drive during a run |
//! | [`paper`] | the paper's four runs and their pinned torque digests |
//! | [`walk`] | a page of `docs/extend`, command by command |
//! | [`wait`] | conditions with deadlines |
//! | [`witness`] | witnesses of a busy machine, for tests of wall-clock time |
//! | [`usb`] | USB devices in software |
//! | [`usb_guest`] | a Linux guest with real USB drivers |
//! | [`optional`] | tests that need equipment which a checkout does not include |
//! | [`own_core`] | a core for each worker and its children |
//!
//! Waits are conditions with deadlines, and every process ends with the test that started it.

#![forbid(unsafe_code)]

pub mod battery;
pub mod c_drive;
pub mod elf;
pub mod fault_table;
pub mod fmu;
pub mod loss;
pub mod optional;
pub mod own_core;
pub mod paper;
pub mod powered;
pub mod processes;
pub mod program;
pub mod python;
pub mod records;
pub mod relay;
pub mod rom_loader;
pub mod scripted;
pub mod terminal;
pub mod twin;
pub mod usb;
pub mod usb_guest;
pub mod wait;
pub mod walk;
pub mod witness;

use std::path::Path;

/// Root of the workspace. Tests name scenarios relative to it, as a user does.
///
/// # Panics
/// The package is not a folder of the workspace.
#[must_use]
pub fn workspace() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the package is a folder of the workspace")
}
