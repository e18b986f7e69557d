//! What the emulated board needs.

use std::env;

use libtest_mimic::Trial;

const EMULATOR: &str = "qemu-system-arm";

/// What is missing here, each with the command that provides it.
pub(crate) fn missing() -> Option<String> {
    let mut missing = Vec::new();
    for image in ["target/lashloop-firmware.elf", "target/codec-cost.elf"] {
        let image = tests::workspace().join(image);
        if !image.is_file() {
            missing.push(format!(
                "there is no image of the firmware at {}: run `cargo xtask image`",
                image.display()
            ));
        }
    }
    let path = env::var_os("PATH").unwrap_or_default();
    if !env::split_paths(&path).any(|folder| folder.join(EMULATOR).is_file()) {
        missing.push(format!("{EMULATOR} is not installed: run `cargo xtask setup`"));
    }
    (!missing.is_empty()).then(|| missing.join("\n"))
}

/// Whether something missing is a failure.
pub(crate) fn nothing_may_be_left_out() -> bool {
    env::var_os("LASHLOOP_LEAVE_NOTHING_OUT").is_some()
}

/// A block that is hard to overlook.
pub(crate) fn say_what_is_left_out(missing: &str, trials: &[Trial]) {
    let rule = "!".repeat(100);
    eprintln!("\n{rule}\nLEFT OUT: the emulated board is not tested, because\n{missing}\n\nNot run:");
    for trial in trials.iter().filter(|trial| trial.has_ignored_flag()) {
        eprintln!("  {}", trial.name());
    }
    eprintln!("`cargo xtask test` provides all of it and leaves nothing out.\n{rule}\n");
}
