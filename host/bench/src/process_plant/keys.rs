//! The keys that both models have.

use lashloop_plant::Key;

/// Key of the folder in which the program runs.
pub const FOLDER: &str = "folder";
/// Key of the files that the program reads.
pub(super) const FILES: &str = "files";

/// The keys of every plant in a process.
pub(super) fn shared() -> Vec<Key> {
    vec![
        Key::text(
            FOLDER,
            "Folder in which the program runs, relative to that of the scenario; that of the scenario if absent.",
        ),
        Key::optional_texts(FILES, "Further files that the plant reads; the record has their hashes."),
        Key::integer(
            "start_timeout_ms",
            "ms",
            10_000,
            1..=600_000,
            "Time from the start of the process to its first line.",
        ),
        Key::integer(
            "step_timeout_ms",
            "ms",
            1000,
            1..=600_000,
            "Time that the process may take for a step.",
        ),
    ]
}
