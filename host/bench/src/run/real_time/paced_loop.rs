//! The loop in real time: one step in every control period.

use std::time::Duration;

use super::pacer::{Pacer, PacingClock, WallClock};
use crate::device::Device;
use crate::run::error::RunError;
use crate::run::outcome::End;
use crate::run::run_loop::RunLoop;
use crate::run::step_sink::StepSink;
use crate::scenario::Scenario;

/// Fraction of a period that is kept free for everything but the exchange: one part in this many.
pub const PERIOD_MARGIN: u32 = 20;

/// Closes the loop for the duration of the scenario. The loop polls the wall clock for the last `spin` of a wait; `None` paces
/// it by the link's clock.
///
/// # Errors
/// The device, its link or the record failed.
pub(in crate::run) fn close<S: StepSink>(
    control: &mut RunLoop<'_, S>,
    scenario: &Scenario,
    device: &mut Device,
    spin: Option<Duration>,
) -> Result<End, RunError> {
    let steps = control.periods();
    let period = Duration::from_micros(scenario.run.control_period_us.into());
    let (mut wall_clock, spin) = (spin.map(|_| WallClock::new()), spin.unwrap_or_default());
    let epoch = match &mut wall_clock {
        Some(clock) => clock.now(),
        None => device.session.line.now(),
    };
    let pacer = Pacer::start(epoch, period, spin);
    for step in 0..steps {
        if control.state().sink.stop_asked() {
            return Ok(End::Interrupted);
        }
        let due = pacer.due(step);
        match device.session.line.idle(due - (spin + period / PERIOD_MARGIN)) {
            // The exchange of the step finds the loss and handles it.
            Err(source) if !source.is_loss() => return Err(device.explain(source).into()),
            _ => {}
        }
        let woke = match &mut wall_clock {
            Some(clock) => pacer.wait_for(due, clock)?,
            None => {
                let woke = pacer.wait_for(due, &mut device.session.line);
                woke.map_err(|source| device.explain(source))?
            }
        };
        let present = pacer.step_at(woke).min(steps);
        if step < present {
            control.miss(step, device)?;
        } else {
            let deadline = due + period - period / PERIOD_MARGIN;
            if let Some(end) = control.step(step, deadline, woke - due, device)? {
                return Ok(end);
            }
        }
    }
    control.complete(device)
}
