//! Conditions with deadlines, instead of fixed sleeps.

use std::thread;
use std::time::{Duration, Instant};

/// Deadline of events that are immediate on an idle machine.
pub const SOON: Duration = Duration::from_secs(30);

/// Time between two evaluations of a condition.
const INTERVAL: Duration = Duration::from_millis(2);

/// Most time that an evaluation counts: a machine that stands still for longer has not waited.
const LONGEST_TURN: Duration = Duration::from_secs(1);

/// Evaluates the condition until it gives a value, for at most `limit`.
pub fn look<T>(limit: Duration, mut condition: impl FnMut() -> Option<T>) -> Option<T> {
    let mut left = limit;
    loop {
        let began = Instant::now();
        if let Some(value) = condition() {
            return Some(value);
        }
        if left.is_zero() {
            return None;
        }
        thread::sleep(INTERVAL);
        left = left.saturating_sub(began.elapsed().min(LONGEST_TURN));
    }
}

/// As [`look`], for [`SOON`].
///
/// # Panics
/// The condition gives no value in time; the message names `what`.
pub fn until<T>(what: &str, condition: impl FnMut() -> Option<T>) -> T {
    look(SOON, condition).unwrap_or_else(|| panic!("{what}: not within {} s", SOON.as_secs()))
}
