//! The whole loop with the Cortex-M image in QEMU: the same torques, bit for bit, and the same ways to fail.
//!
//! Image and emulator don't come with a checkout. Where one is missing the trials are ignored, loudly; with
//! `LASHLOOP_LEAVE_NOTHING_OUT` set, as `cargo xtask test` sets it, they fail instead. That choice is made when the
//! tests run, which is why this binary has a harness of its own.

mod codec;
mod codec_cost;
mod conforming;
mod equipment;
mod lost;
mod runs;

use std::process::ExitCode;

use libtest_mimic::{Arguments, Failed, Trial};
use tests::paper::RUNS;

type Check = fn();

/// Trials that need image and emulator, by their names.
const TRIALS: [(&str, Check); 8] = [
    ("codec::reading_and_writing_a_message_takes_few_instructions", codec::every_message),
    ("conforming::the_image_passes_every_check_and_none_is_left_out", conforming::every_check),
    ("lost::a_killed_emulator_is_reported_with_its_process_and_signal", lost::killed),
    ("lost::an_emulator_that_hangs_is_reported_as_silent_and_not_left_behind", lost::stopped),
    ("lost::a_killed_bench_leaves_no_emulator_behind", lost::bench_killed),
    ("lost::an_interrupted_bench_leaves_no_emulator_behind", lost::bench_interrupted),
    ("runs::the_image_says_who_it_is", runs::identity),
    ("runs::an_image_that_locks_the_processor_up_is_reported_with_the_emulator_s_reason", runs::stranger),
];

fn main() -> ExitCode {
    let mut arguments = Arguments::from_args();
    // An emulated board takes a core and the bench another.
    arguments.test_threads = Some(1);
    let missing = equipment::missing();
    let mut trials: Vec<_> =
        TRIALS.into_iter().map(|(name, check)| trial(name, missing.clone(), check)).collect();
    for run in RUNS {
        let name = format!("runs::{}_is_the_same_run_as_in_process", run.name.replace('-', "_"));
        trials.push(trial(&name, missing.clone(), move || runs::same_as_in_process(run)));
    }
    trials.push(trial(
        "runs::an_image_that_is_not_there_is_named_with_the_command_that_builds_it",
        None,
        runs::no_image,
    ));
    if let Some(missing) = missing.filter(|_| !equipment::nothing_may_be_left_out() && !arguments.list) {
        equipment::say_what_is_left_out(&missing, &trials);
    }
    libtest_mimic::run(&arguments, trials).exit_code()
}

/// A trial that is ignored, or fails, if something is missing.
fn trial(name: &str, missing: Option<String>, check: impl FnOnce() + Send + 'static) -> Trial {
    let ignored = missing.is_some() && !equipment::nothing_may_be_left_out();
    let run = move || match missing {
        Some(missing) => Err(Failed::from(missing)),
        None => {
            check();
            Ok(())
        }
    };
    Trial::test(name, run).with_ignored_flag(ignored)
}
