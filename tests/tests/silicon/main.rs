//! The unmodified Cortex-M image on virtual silicon: register-level models of its chip.
//!
//! Every run here also shows that the chip serves all accesses of the image: virtual silicon ends at the first that it
//! doesn't. The models are made from the manual and aren't hardware.

#[path = "../../../host/identify/tests/identify/hidden_plants/keys.rs"]
mod hidden_plant_keys;
#[allow(dead_code, reason = "the tests of the estimates use more of it")]
#[path = "../../../host/identify/tests/identify/hidden_plants/mod.rs"]
mod hidden_plants;
#[allow(dead_code, reason = "the script of the document needs sections alone")]
#[path = "../../../protocol/tests/wire/markdown.rs"]
mod markdown;
#[path = "../document/script.rs"]
mod script;

mod against_hil;
mod bench_mode;
mod commission;
mod conversation;
mod electrical;
mod equipment;
mod experiment;
mod flash;
mod runs;
mod walk;

use std::process::ExitCode;

use libtest_mimic::{Arguments, Trial};
use tests::paper::{BACKLASH_INVERSE, RUNS};
use tests::{fault_table, optional, own_core, rom_loader};

type Check = fn();

/// Trials that need the image and the program.
const TRIALS: [(&str, Check); 25] = [
    ("conversation::the_documented_frames_come_back_byte_by_byte", conversation::byte_by_byte),
    ("runs::the_image_identifies_itself_as_the_board", runs::identity),
    ("runs::the_rate_of_steps_is_reported", runs::speed),
    ("runs::a_killed_process_is_reported_with_its_signal", runs::killed),
    ("runs::a_file_that_is_no_image_is_named", runs::stranger),
    ("runs::an_image_without_the_protocol_is_reported_as_silent", runs::silent),
    ("bench_mode::a_run_repeats_bit_for_bit", bench_mode::repeats),
    ("bench_mode::the_image_passes_every_check_of_bench_mode", bench_mode::conforms),
    ("bench_mode::a_run_at_4_khz_takes_every_fourth_report", bench_mode::reports_every_fourth_step),
    ("bench_mode::other_boards_run_on_their_own_pins", bench_mode::other_boards),
    ("bench_mode::other_boards_have_the_torques_of_the_process", bench_mode::hil_of_other_boards),
    ("walk::the_page_about_a_board_of_your_own_leads_there", walk::own_board),
    ("walk::the_page_about_an_image_in_c_leads_to_a_pass", walk::image_in_c),
    ("walk::the_image_in_c_conforms", walk::image_in_c_conforms),
    ("bench_mode::a_missed_expectation_fails_the_run", bench_mode::fails),
    ("bench_mode::a_silent_host_trips_the_watchdog", bench_mode::unplugged_for_a_while),
    ("bench_mode::a_disconnected_host_has_no_verdict", bench_mode::unplugged_for_good),
    ("against_hil::the_experiment_differs_from_its_simulation_as_explained", against_hil::experiment),
    ("commission::truth_of_hidden_plants_is_within_the_intervals", commission::hidden_plants),
    ("electrical::a_motor_at_a_bridge_is_within_its_intervals", electrical::found),
    ("electrical::a_reversed_sensor_moves_nothing_by_a_loop", electrical::reversed),
    ("electrical::a_wrong_scale_of_the_sensor_ends_before_the_mechanics", electrical::wrong_scale),
    ("experiment::a_person_brings_the_load_to_its_start", experiment::waits_for_the_start),
    ("experiment::a_motor_at_a_bridge_has_no_static_error_after_compensation", experiment::at_a_bridge),
    ("faults::the_watchdog_removes_the_torque_in_time", || {
        fault_table::check_watchdog_on("silicon", 0.2);
    }),
];

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    let missing = equipment::missing();
    let mut trials: Vec<_> =
        TRIALS.into_iter().map(|(name, check)| trial(name, missing.clone(), check)).collect();
    for run in RUNS.into_iter().chain([BACKLASH_INVERSE]) {
        let name = format!("runs::{}_has_the_torques_of_the_run_in_process", run.name.replace('-', "_"));
        trials.push(trial(&name, missing.clone(), move || run.check_start_on("silicon", 3)));
    }
    let without_loader = missing.clone().or_else(rom_loader::missing);
    let name = "flash::an_image_that_its_boot_loader_has_received_runs_and_is_confirmed";
    trials.push(trial(name, without_loader, flash::received));
    trials.push(trial("runs::a_missing_image_is_named_with_its_build_command", None, runs::no_image));
    optional::run(&arguments, "virtual silicon", missing.as_deref(), trials)
}

fn trial(name: &str, missing: Option<String>, check: impl FnOnce() + Send + 'static) -> Trial {
    optional::trial(name, missing, || {
        own_core::keep();
        check();
    })
}
