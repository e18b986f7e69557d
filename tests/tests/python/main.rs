//! The drive of the Python package, written from `docs/protocol.md`, on the bench.

mod conforming;
mod runs;

use std::process::ExitCode;

use libtest_mimic::Arguments;
use tests::optional::{self, trial};
use tests::python;

type Check = fn();

const TRIALS: [(&str, Check); 5] = [
    ("conforming::the_python_drive_passes_every_check_and_none_is_left_out", conforming::every_check),
    ("runs::the_paper_s_run_before_compensation_has_the_torques_of_the_firmware_to_the_bit", runs::smooth),
    ("runs::the_paper_s_run_with_friction_has_the_torques_of_the_firmware_to_the_bit", runs::friction),
    ("runs::a_control_law_that_is_not_offered_is_named_with_those_that_are", runs::not_offered),
    ("runs::a_drive_that_stays_serves_one_run_after_the_other", runs::again),
];

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    let missing = python::missing();
    let trials = TRIALS.into_iter().map(|(name, check)| trial(name, missing.clone(), check)).collect();
    optional::run(&arguments, "the Python drive", missing.as_deref(), trials)
}
