//! Equipment of the emulated board.

use std::env;

const EMULATOR: &str = "qemu-system-arm";

/// Names missing equipment, each with the command that installs it.
pub(crate) fn missing() -> Option<String> {
    let mut missing = Vec::new();
    for image in ["target/lashloop-firmware.elf", "target/codec-cost.elf", "target/own-law-image.elf"] {
        let image = tests::workspace().join(image);
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
