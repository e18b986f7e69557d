//! The bench in a Linux guest with the kernel's own USB serial drivers: `ftdi_sio` with an adapter in software and with
//! QEMU's, `cdc_acm` with the drive's own USB class code.
//!
//! A checkout does not include the guest, see [`optional`]. All trials share one boot, unless one fails.

mod adapter;
mod drive_port;
mod emulated_adapter;
mod flash;
mod machine;
mod unplugs;

use std::process::ExitCode;

use libtest_mimic::Arguments;
use machine::Machine;
use tests::optional;
use tests::usb_guest::equipment;

type Check = fn(&mut Machine);

const TRIALS: [(&str, Check); 20] = [
    ("adapter::ports_lists_identity_and_stable_name", adapter::listed),
    ("adapter::a_run_has_the_torques_of_the_drive_in_process", adapter::torques),
    ("adapter::a_user_is_warned_of_the_latency_timer", adapter::warned),
    ("adapter::an_opening_by_root_shortens_the_latency_timer", adapter::shortened),
    ("adapter::the_documented_udev_rule_shortens_the_latency_timer", adapter::udev_rule),
    ("adapter::a_held_port_is_reported_as_held", adapter::held),
    ("adapter::a_run_resumes_after_a_replug_by_its_stable_name", adapter::resumed),
    ("adapter::a_run_does_not_resume_on_another_adapter_of_the_old_name", adapter::other_adapter),
    ("drive_port::ports_lists_identity_and_stable_name", drive_port::listed),
    ("drive_port::doctor_finds_nothing_wrong", drive_port::healthy),
    ("drive_port::a_run_has_the_torques_of_the_drive_in_process", drive_port::torques),
    ("drive_port::every_check_of_conformance_passes", drive_port::conforming),
    ("drive_port::a_run_resumes_after_a_replug_by_its_stable_name", drive_port::resumed),
    ("emulated_adapter::a_run_has_the_torques_of_the_drive_in_process", emulated_adapter::torques),
    ("emulated_adapter::a_run_resumes_after_a_replug", emulated_adapter::resumed),
    ("flash::an_unplug_before_the_first_block_writes_nothing", flash::before_the_first_block),
    ("flash::an_unplug_between_blocks_is_not_flashed", flash::between_blocks),
    ("flash::an_unplug_after_the_start_is_written_and_not_confirmed", flash::after_the_start),
    ("unplugs::of_an_adapter_under_load_are_all_resumed", unplugs::of_an_adapter),
    ("unplugs::of_a_drive_port_under_load_are_all_resumed", unplugs::of_a_drive),
];

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    let missing = equipment::missing();
    let trials = TRIALS
        .into_iter()
        .map(|(name, check)| optional::trial(name, missing.clone(), move || machine::try_out(name, check)));
    let code = optional::run(&arguments, "the USB guest", missing.as_deref(), trials.collect());
    machine::switch_off();
    code
}
