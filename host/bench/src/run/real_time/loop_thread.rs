//! The loop's own thread.

use std::thread;
use std::time::Duration;

/// Time between two calls that drain the finished steps.
const DRAIN_INTERVAL: Duration = Duration::from_millis(5);

/// Runs `work` on a thread of its own while `drain` is called on this one every few milliseconds, and once after the end.
///
/// # Errors
/// The system refused the thread.
pub(in crate::run) fn run_with_drain<T: Send>(
    work: impl FnOnce() -> T + Send,
    mut drain: impl FnMut(),
) -> Result<T, std::io::Error> {
    thread::scope(|scope| {
        let work = thread::Builder::new().name("loop".to_owned()).spawn_scoped(scope, work)?;
        while !work.is_finished() {
            drain();
            thread::sleep(DRAIN_INTERVAL);
        }
        let done = work.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        drain();
        Ok(done)
    })
}
