//! The whole loop with the Cortex-M image in QEMU: the same torques, bit for bit, and the same failures.
//!
//! A checkout does not include image and emulator, see [`optional`].

mod codec;
mod codec_cost;
mod conforming;
mod drive_loss;
mod equipment;
mod faults;
mod flash;
mod instructions;
mod own_law;
mod runs;

use std::process::ExitCode;

use libtest_mimic::{Arguments, Trial};
use tests::paper::{BACKLASH_INVERSE, BRAKING_CURVE, PaperRun, RUNS};
use tests::{fault_table, optional, own_core};

/// The run that is compared in whole, besides the law that identifies most.
const SMOOTH_AFTER: PaperRun = RUNS[1];

type Check = fn();

/// Trials that need image and emulator.
const TRIALS: [(&str, Check); 16] = [
    ("codec::encoding_and_decoding_take_few_instructions", codec::every_message),
    ("conforming::the_image_passes_every_check_it_can_show", conforming::every_check),
    ("faults::the_run_without_faults_passes", || fault_table::check_healthy_on("qemu")),
    ("faults::the_watchdog_removes_the_torque_in_time", || {
        fault_table::check_watchdog_on("qemu", 0.2);
    }),
    ("faults::a_pause_in_lockstep_trips_no_watchdog", || fault_table::check_pause_on("qemu")),
    ("flash::the_bytes_for_the_flash_boot_and_report_the_build_of_the_elf", flash::bytes_boot),
    ("instructions::a_control_step_of_every_law_keeps_its_budget", instructions::of_every_law),
    (
        "instructions::a_control_step_of_every_published_law_keeps_its_budget",
        instructions::of_every_published_law,
    ),
    ("drive_loss::a_killed_emulator_is_reported_with_its_process_and_signal", drive_loss::killed),
    ("drive_loss::a_stopped_emulator_is_waited_for", drive_loss::stopped),
    ("drive_loss::a_killed_bench_leaves_no_emulator_behind", drive_loss::bench_killed),
    ("drive_loss::an_interrupted_bench_leaves_no_emulator_behind", drive_loss::bench_interrupted),
    ("own_law::the_image_has_the_torques_of_the_twin_and_of_the_process", own_law::equal_torques),
    ("own_law::the_image_passes_every_check", own_law::conforming),
    ("runs::the_image_identifies_itself", runs::identity),
    ("runs::a_processor_lockup_is_reported_with_its_reason", runs::stranger),
];

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    let missing = equipment::missing();
    let mut trials: Vec<_> =
        TRIALS.into_iter().map(|(name, check)| trial(name, missing.clone(), check)).collect();
    for run in [SMOOTH_AFTER, BRAKING_CURVE] {
        let name = format!("runs::{}_is_the_same_run_as_in_process", run.name.replace('-', "_"));
        trials.push(trial(&name, missing.clone(), move || runs::same_as_in_process(run)));
    }
    // The load arrives within these seconds. A step in QEMU takes a millisecond, and the rest of 25 s shows the same again.
    for run in RUNS.into_iter().chain([BACKLASH_INVERSE]).filter(|run| run.name != SMOOTH_AFTER.name) {
        let name = format!("runs::{}_starts_as_in_process", run.name.replace('-', "_"));
        trials.push(trial(&name, missing.clone(), move || run.check_start_on("qemu", 6)));
    }
    for (number, row) in faults::rows() {
        let name = format!("faults::row_{number:02}_{}_matches_the_table", row.kind().replace('-', "_"));
        trials.push(trial(&name, missing.clone(), move || row.check_on("qemu")));
    }
    trials.push(trial("runs::a_missing_image_is_named_with_its_build_command", None, runs::no_image));
    optional::run(&arguments, "the emulated board", missing.as_deref(), trials)
}

fn trial(name: &str, missing: Option<String>, check: impl FnOnce() + Send + 'static) -> Trial {
    optional::trial(name, missing, || {
        own_core::keep();
        check();
    })
}
