//! Equipment of the emulated board.

use std::env;

const EMULATOR: &str = "qemu-system-arm";

/// Names missing equipment, each with the command that installs it.
pub(crate) fn missing() -> Option<String> {
    let mut missing = Vec::new();
    for program in ["lashloop-firmware", "codec-cost", "own-law-image", "published-laws-image"] {
        let image = tests::workspace().join(format!("target/{program}.elf"));
        if !image.is_file() {
            missing.push(format!("no image of the firmware at {}: run `cargo xtask image`", image.display()));
        }
    }
    let path = env::var_os("PATH").unwrap_or_default();
    if !env::split_paths(&path).any(|folder| folder.join(EMULATOR).is_file()) {
        missing.push(format!("{EMULATOR} is not installed: run `cargo xtask setup`"));
    }
    (!missing.is_empty()).then(|| missing.join("\n"))
}
