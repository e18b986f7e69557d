//! The drive of the Python package, written from `docs/protocol.md`, on the bench.

mod conforming;
mod runs;

use std::process::ExitCode;

use libtest_mimic::Arguments;
use tests::optional::{self, trial};
use tests::python;

type Check = fn();

const TRIALS: [(&str, Check); 5] = [
    ("conforming::the_python_drive_passes_every_check_and_none_is_omitted", conforming::every_check),
    ("runs::the_smooth_run_has_the_torques_of_the_firmware_bit_for_bit", runs::smooth),
    ("runs::the_friction_run_has_the_torques_of_the_firmware_bit_for_bit", runs::friction),
    ("runs::an_unknown_control_law_is_rejected_with_the_known_ones", runs::not_offered),
    ("runs::one_drive_serves_several_runs", runs::again),
];

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    let missing = python::missing();
    let trials = TRIALS.into_iter().map(|(name, check)| trial(name, missing.clone(), check)).collect();
    optional::run(&arguments, "the Python drive", missing.as_deref(), trials)
}
