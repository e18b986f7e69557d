//! Conditions with deadlines, in place of sleeps that hope.

use std::thread;
use std::time::{Duration, Instant};

/// For everything that happens soon on a machine that isn't busy, and still does on one that is.
pub const SOON: Duration = Duration::from_secs(30);

/// Time between two looks.
const INTERVAL: Duration = Duration::from_millis(2);

/// Looks until there is a value, for at most `limit`.
pub fn look<T>(limit: Duration, mut condition: impl FnMut() -> Option<T>) -> Option<T> {
    let deadline = Instant::now() + limit;
    loop {
        if let Some(value) = condition() {
            return Some(value);
        }
        if Instant::now() >= deadline {
            return None;
        }
        thread::sleep(INTERVAL);
    }
}

/// As [`look`], for [`SOON`]; the test fails when `what` did not come.
///
/// # Panics
/// It did not come.
pub fn until<T>(what: &str, condition: impl FnMut() -> Option<T>) -> T {
    look(SOON, condition).unwrap_or_else(|| panic!("{what}: not within {} s", SOON.as_secs()))
}
