//! Equipment of virtual silicon.

use std::path::PathBuf;

/// The image of the drive.
pub(crate) fn image() -> PathBuf {
    tests::workspace().join("target/lashloop-firmware.elf")
}

/// The image that fails on request.
pub(crate) fn probe() -> PathBuf {
    tests::workspace().join("target/silicon-probe.elf")
}

/// The program.
pub(crate) fn program() -> PathBuf {
    tests::workspace().join("target/virtual-silicon/release/lashloop-silicon")
}

/// Names missing equipment, each with the command that builds it.
pub(crate) fn missing() -> Option<String> {
    let needed = [
        (image(), "cargo xtask image"),
        (program(), "cargo xtask silicon"),
        (probe(), "cargo xtask test silicon"),
    ];
    let missing = needed.into_iter().filter(|(path, _)| !path.is_file());
    let lines: Vec<_> =
        missing.map(|(path, by)| format!("{} is missing: run `{by}`", path.display())).collect();
    (!lines.is_empty()).then(|| lines.join("\n"))
}
