//! Real time: one step in every control period of the clock on the wall.
//!
//! The loop has a thread of its own. It wakes at absolute times, the start of the run plus whole periods, so no lateness
//! adds up. A torque that is not there at the end of its step is late: the last one is held, and nothing is repeated or
//! made up for. If the bench itself sleeps through whole steps, the plant goes on with the torque it has, the steps count as
//! missed, and the loop goes on where the clock is: never a burst.
//!
//! The thread neither allocates nor locks nor writes: finished steps go through a ring to the caller's thread, which
//! measures and records them.

#[cfg(test)]
mod allocations;
mod pacer;
mod privileges;
mod ring;

use std::thread;
use std::time::Duration;

use super::control_loop::{ControlLoop, Sink};
use super::{End, RunError};
use crate::device::Device;
use crate::scenario::Scenario;

use pacer::Pacer;
pub use privileges::obtain;
pub(super) use ring::{Ring, drain};

/// What the loop's thread asks of the system.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct RealTime {
    /// How long before a step the thread stops sleeping and looks at the clock without pause.
    pub spin: Duration,
    /// Priority under SCHED_FIFO, 1 to 99.
    pub fifo_priority: Option<u8>,
    /// Keep all memory of the process from being paged out.
    pub lock_memory: bool,
    /// The core to stay on.
    pub core: Option<usize>,
}

/// What is left of a period for everything but the answer: one part in so many.
pub const PERIOD_MARGIN: u32 = 20;

/// How often the caller's thread looks for finished steps.
const LOOK: Duration = Duration::from_millis(5);

/// Closes the loop for the duration of the scenario.
///
/// # Errors
/// Device, link or record failed.
pub(super) fn close<S: Sink>(
    control: &mut ControlLoop<'_, S>,
    scenario: &Scenario,
    device: &mut Device,
    spin: Duration,
) -> Result<End, RunError> {
    let steps = scenario.run.steps();
    let period = Duration::from_micros(scenario.run.control_period_us.into());
    let pacer = Pacer::start(period, spin);
    let mut step = 0;
    while step < steps {
        if control.stop_asked() {
            return Ok(End::Interrupted);
        }
        let due = pacer.due(step);
        match device.session.idle(due - (spin + period / PERIOD_MARGIN)) {
            // The step is about to find out.
            Err(source) if !source.is_loss() => return Err(device.explain(source).into()),
            _ => {}
        }
        let woke = pacer.wait_for(due)?;
        let present = pacer.step_at(woke).min(steps);
        let outcome = if step < present {
            control.miss(step, device).map(|()| None)
        } else {
            control.step(step, due + period - period / PERIOD_MARGIN, woke - due, device)
        };
        match outcome {
            Ok(None) => step += 1,
            Ok(Some(end)) => return Ok(end),
            Err(error) => return error.end(),
        }
    }
    Ok(End::Complete)
}

/// Runs `work` on a thread of its own while `look` is called on this one every few milliseconds, and once more at the end.
///
/// # Errors
/// The system refused the thread.
pub(super) fn run_with_drain<T: Send>(
    work: impl FnOnce() -> T + Send,
    mut look: impl FnMut(),
) -> Result<T, std::io::Error> {
    thread::scope(|scope| {
        let work = thread::Builder::new().name("loop".to_owned()).spawn_scoped(scope, work)?;
        while !work.is_finished() {
            look();
            thread::sleep(LOOK);
        }
        let done = work.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        look();
        Ok(done)
    })
}
