//! Trials that need something a checkout does not have. Where it is missing they are ignored, loudly; with
//! `LASHLOOP_LEAVE_NOTHING_OUT` set, as `cargo xtask test` sets it, they fail instead. That choice is made when the tests
//! run, which is why such tests have a harness of their own.

use std::env;
use std::process::ExitCode;

use libtest_mimic::{Arguments, Failed, Trial};

/// A trial that is ignored, or fails, if something is missing.
pub fn trial(name: &str, missing: Option<String>, check: impl FnOnce() + Send + 'static) -> Trial {
    let ignored = missing.is_some() && !nothing_may_be_left_out();
    let run = move || match missing {
        Some(missing) => Err(Failed::from(missing)),
        None => {
            check();
            Ok(())
        }
    };
    Trial::test(name, run).with_ignored_flag(ignored)
}

/// Runs the trials. `what` is not tested if something is missing.
#[must_use]
pub fn run(arguments: &Arguments, what: &str, missing: Option<&str>, trials: Vec<Trial>) -> ExitCode {
    if let Some(missing) = missing.filter(|_| !nothing_may_be_left_out() && !arguments.list) {
        say_what_is_left_out(what, missing, &trials);
    }
    libtest_mimic::run(arguments, trials).exit_code()
}

/// Whether something missing is a failure.
fn nothing_may_be_left_out() -> bool {
    env::var_os("LASHLOOP_LEAVE_NOTHING_OUT").is_some()
}

/// A block that is hard to overlook.
fn say_what_is_left_out(what: &str, missing: &str, trials: &[Trial]) {
    let rule = "!".repeat(100);
    eprintln!("\n{rule}\nLEFT OUT: {what} is not tested, because\n{missing}\n\nNot run:");
    for trial in trials.iter().filter(|trial| trial.has_ignored_flag()) {
        eprintln!("  {}", trial.name());
    }
    eprintln!("`cargo xtask test` provides all of it and leaves nothing out.\n{rule}\n");
}
