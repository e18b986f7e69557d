//! `lashloop flash` against software loaders: the ROM loader on a pseudo-terminal with the real stm32flash, and programs that
//! stand for probe-rs and dfu-util and check their command lines.
//!
//! No chip is in these tests. The loader is made from ST's documents; the command lines of probe-rs and dfu-util are those of
//! their manuals.

mod bench;
mod image;
mod stand_ins;
mod uart;

use std::process::ExitCode;

use libtest_mimic::Arguments;
use tests::optional::{self, trial};
use tests::rom_loader;

type Check = fn();

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    let stm32flash = rom_loader::missing();
    let with_stm32flash: [(&str, Check); 9] = [
        ("uart::the_image_alone_is_written_and_not_confirmed_by_silence", uart::written),
        ("uart::a_loader_next_to_an_answering_drive_is_not_written", uart::another_chip),
        ("uart::a_running_drive_enters_its_boot_loader_by_request", uart::by_request),
        ("uart::a_drive_gets_no_request_for_a_loader_elsewhere", uart::no_request),
        ("uart::a_drive_gets_no_request_for_the_image_of_another_board", uart::no_request_for_other_board),
        ("uart::a_loader_that_no_way_reaches_is_reported_with_the_way_back", uart::unreached),
        ("uart::a_chip_that_does_not_take_the_image_is_reported_with_the_recovery", uart::not_taken),
        ("uart::an_interruption_ends_stm32flash_and_names_the_recovery", uart::interrupted),
        ("uart::a_running_drive_is_no_boot_loader", uart::no_loader),
    ];
    let alone: [(&str, Check); 26] = [
        ("image::segments_are_one_piece_with_erased_gaps", image::gaps),
        ("image::an_image_beyond_the_flash_is_rejected", image::beyond),
        ("image::an_image_for_another_address_is_rejected", image::elsewhere),
        ("image::an_image_without_vectors_is_rejected", image::no_vectors),
        ("image::a_program_for_measurements_is_rejected", image::no_drive),
        ("image::files_that_are_no_image_are_rejected", image::no_elf),
        ("stand_ins::a_probe_writes_compares_and_resets", stand_ins::probe),
        ("stand_ins::a_drive_in_a_run_is_not_halted", stand_ins::run_in_progress),
        ("stand_ins::the_rig_file_chooses_probe_and_chip", stand_ins::probe_of_rig),
        ("stand_ins::without_a_handshake_a_probe_connects_under_reset", stand_ins::under_reset),
        ("stand_ins::an_image_for_another_board_is_not_written", stand_ins::other_board),
        ("stand_ins::an_image_without_build_or_board_is_not_written", stand_ins::no_build),
        ("stand_ins::another_build_of_the_drive_is_not_flashed", stand_ins::other_build),
        ("stand_ins::a_simulator_is_not_flashed", stand_ins::simulator),
        ("stand_ins::two_probes_need_a_choice", stand_ins::two_probes),
        ("stand_ins::dfu_writes_reads_back_and_leaves", stand_ins::dfu),
        (
            "stand_ins::a_chip_in_its_loader_next_to_an_answering_drive_is_not_written",
            stand_ins::another_chip,
        ),
        ("stand_ins::a_chip_without_a_port_afterwards_is_not_confirmed", stand_ins::no_port),
        ("stand_ins::a_chip_without_a_drive_needs_the_name_of_its_board", stand_ins::blank_chip),
        ("stand_ins::the_loader_program_ends_with_a_killed_bench", stand_ins::killed),
        ("stand_ins::dfu_with_a_different_copy_is_not_flashed", stand_ins::dfu_different),
        ("stand_ins::a_download_that_fails_is_not_flashed", stand_ins::download_failed),
        ("stand_ins::a_chip_that_is_not_reset_is_not_flashed", stand_ins::reset_failed),
        ("stand_ins::the_output_of_a_failed_program_is_quoted_escaped", stand_ins::failed),
        ("stand_ins::without_a_way_each_has_its_reason", stand_ins::no_way),
        ("stand_ins::a_rig_in_use_is_not_flashed", stand_ins::rig_in_use),
    ];
    let mut trials: Vec<_> =
        with_stm32flash.into_iter().map(|(name, check)| trial(name, stm32flash.clone(), check)).collect();
    trials.extend(alone.into_iter().map(|(name, check)| trial(name, None, check)));
    optional::run(&arguments, "flashing by stm32flash", stm32flash.as_deref(), trials)
}
