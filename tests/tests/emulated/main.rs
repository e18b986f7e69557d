//! The whole loop with the Cortex-M image in QEMU: the same torques, bit for bit, and the same faults.
//!
//! Image and emulator are equipment that a checkout doesn't have, see [`optional`].

mod codec;
mod codec_cost;
mod conforming;
mod equipment;
mod instructions;
mod lost;
mod runs;

use std::process::ExitCode;

use libtest_mimic::Arguments;
use tests::fault_table;
use tests::optional::{self, trial};
use tests::paper::{BACKLASH_INVERSE, RUNS};

type Check = fn();

/// Trials that need image and emulator, by their names.
const TRIALS: [(&str, Check); 12] = [
    ("codec::a_message_is_coded_in_few_instructions", codec::every_message),
    ("conforming::the_image_passes_every_check_and_none_is_omitted", conforming::every_check),
    ("faults::the_run_without_faults_passes", || fault_table::check_healthy_on("qemu")),
    ("faults::the_watchdog_removes_the_torque_within_its_timeout", || {
        fault_table::check_watchdog_on("qemu");
    }),
    ("faults::a_bench_that_pauses_in_lockstep_trips_no_watchdog", || fault_table::check_pause_on("qemu")),
    ("instructions::a_control_step_of_every_law_keeps_its_budget", instructions::of_every_law),
    ("lost::a_killed_emulator_is_reported_with_its_process_and_signal", lost::killed),
    ("lost::an_emulator_that_hangs_is_reported_as_silent_and_killed", lost::stopped),
    ("lost::a_killed_bench_leaves_no_emulator_behind", lost::bench_killed),
    ("lost::an_interrupted_bench_leaves_no_emulator_behind", lost::bench_interrupted),
    ("runs::the_image_identifies_itself", runs::identity),
    ("runs::a_processor_lockup_is_reported_with_the_cause", runs::stranger),
];

fn main() -> ExitCode {
    // An emulated board and its bench take turns, so each trial keeps one core busy.
    let arguments = Arguments::from_args();
    let missing = equipment::missing();
    let mut trials: Vec<_> =
        TRIALS.into_iter().map(|(name, check)| trial(name, missing.clone(), check)).collect();
    for run in RUNS.into_iter().chain([BACKLASH_INVERSE]) {
        let name = format!("runs::{}_is_the_same_run_as_in_process", run.name.replace('-', "_"));
        trials.push(trial(&name, missing.clone(), move || runs::same_as_in_process(run)));
    }
    for (number, row) in fault_table::rows().into_iter().enumerate() {
        let name =
            format!("faults::row_{:02}_{}_matches_the_table", number + 1, row.kind().replace('-', "_"));
        trials.push(trial(&name, missing.clone(), move || row.check_on("qemu")));
    }
    trials.push(trial(
        "runs::a_missing_image_is_named_with_the_command_that_builds_it",
        None,
        runs::no_image,
    ));
    optional::run(&arguments, "the emulated board", missing.as_deref(), trials)
}
