//! The drive of the Python package, written from `docs/protocol.md`, on the bench.

mod conforming;
mod fmu;
mod runs;

use std::process::ExitCode;

use libtest_mimic::Arguments;
use tests::optional::{self, trial};
use tests::python;

type Check = fn();

const TRIALS: [(&str, Check); 11] = [
    (
        "conforming::the_python_drive_passes_every_check_and_none_but_of_bench_mode_is_skipped",
        conforming::every_check,
    ),
    ("conforming::the_drive_of_the_package_fails_no_check", conforming::the_package_s_own),
    ("runs::smooth_before_has_the_torque_bits_of_the_firmware", runs::smooth),
    ("runs::friction_before_has_the_torque_bits_of_the_firmware", runs::friction),
    ("runs::a_law_that_is_not_offered_is_named_with_those_offered", runs::not_offered),
    ("walk::the_page_about_a_drive_in_python_leads_there", || {
        let python = python::interpreter();
        tests::walk::through("docs/extend/drive-in-python.md", &[python.parent().expect("its folder")]);
    }),
    ("runs::a_drive_started_by_the_bench_has_the_torque_bits_of_the_firmware", runs::started_by_the_bench),
    ("runs::one_drive_serves_consecutive_runs", runs::again),
    ("fmu::an_fmu_of_pythonfmu_moves_as_the_smooth_plant_does", fmu::two),
    ("fmu::an_fmu_of_pythonfmu3_moves_as_the_smooth_plant_does", fmu::three),
    ("fmu::an_fmu_for_model_exchange_runs_with_the_solver_of_fmpy", fmu::model_exchange),
];

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    let missing = python::missing();
    let trials = TRIALS.into_iter().map(|(name, check)| trial(name, missing.clone(), check)).collect();
    optional::run(&arguments, "the Python drive", missing.as_deref(), trials)
}
