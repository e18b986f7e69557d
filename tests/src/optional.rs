//! Trials that need equipment which a checkout doesn't have. Where it is missing they are ignored with a notice. With
//! `LASHLOOP_REQUIRE_EQUIPMENT` set, as `cargo xtask test` sets it, they fail. The choice is made at run time, which is
//! why such tests have a harness of their own.

use std::env;
use std::process::ExitCode;

use libtest_mimic::{Arguments, Failed, Trial};

/// A trial that is ignored, or fails, if equipment is missing.
pub fn trial(name: &str, missing: Option<String>, check: impl FnOnce() + Send + 'static) -> Trial {
    let ignored = missing.is_some() && !is_equipment_required();
    let run = move || match missing {
        Some(missing) => Err(Failed::from(missing)),
        None => {
            check();
            Ok(())
        }
    };
    Trial::test(name, run).with_ignored_flag(ignored)
}

/// Runs the trials of `subject`.
#[must_use]
pub fn run(arguments: &Arguments, subject: &str, missing: Option<&str>, trials: Vec<Trial>) -> ExitCode {
    if let Some(missing) = missing.filter(|_| !is_equipment_required() && !arguments.list) {
        print_omitted(subject, missing, &trials);
    }
    libtest_mimic::run(arguments, trials).exit_code()
}

fn is_equipment_required() -> bool {
    env::var_os("LASHLOOP_REQUIRE_EQUIPMENT").is_some()
}

/// A block that is hard to overlook.
fn print_omitted(subject: &str, missing: &str, trials: &[Trial]) {
    let rule = "!".repeat(100);
    eprintln!("\n{rule}\nOMITTED: tests of {subject}, because\n{missing}\n\nNot run:");
    for trial in trials.iter().filter(|trial| trial.has_ignored_flag()) {
        eprintln!("  {}", trial.name());
    }
    eprintln!(
        "`cargo xtask setup` installs the equipment. `cargo xtask test` counts these tests as failed, or as left out if a mirror \
         lacks the packages of guest or Slurm.\n{rule}\n"
    );
}
