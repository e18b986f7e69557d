//! SIGINT and SIGTERM.

use std::sync::atomic::{AtomicBool, Ordering};

/// What a shell reports of a program that Ctrl-C ended.
const KILLED: i32 = 130;

/// What a signal does.
#[derive(Default)]
pub(super) struct Signals {
    /// The bench polls [`Self::is_requested`] and ends by itself.
    guarded: AtomicBool,
    requested: AtomicBool,
}

impl Signals {
    pub(super) fn set_guarded(&self, guarded: bool) {
        self.guarded.store(guarded, Ordering::Relaxed);
    }

    /// Whether a signal has asked the bench to stop.
    pub(super) fn is_requested(&self) -> bool {
        self.requested.load(Ordering::Relaxed)
    }

    /// Handles a signal. Without a guard, and at the second signal, the process ends; the kernel ends its children.
    pub(super) fn arrived(&self) {
        if self.requested.swap(true, Ordering::Relaxed) || !self.guarded.load(Ordering::Relaxed) {
            std::process::exit(KILLED);
        }
    }
}
