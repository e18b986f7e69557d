//! What a person sees of a run while it lasts: progress on the terminal, and the live page.

use std::time::{Duration, Instant, SystemTime};

use lashloop_bench::atomic_file::WriteError;
use lashloop_bench::run::{Event, RunStart, Step, StepObserver};
use lashloop_bench::scenario::expectation::Expectation;
use lashloop_bench::scenario::{RunMode, Scenario};
use lashloop_bench::timing::{ClockName, Timings};
use lashloop_plant::metrics::{Measurement, Plan, SignalTable};

use super::progress::RunProgress;
use lashloop_live::{Publisher, SoFar, Status};

/// Time between two states of the live page.
const STATUS_INTERVAL: Duration = Duration::from_millis(250);

/// Measures a run on the side, for the verdict so far.
pub(super) struct Monitor<'a> {
    scenario: &'a Scenario,
    progress: Option<RunProgress>,
    live: Option<Publisher>,
    /// From the start of the run on.
    begun: Option<Begun>,
}

struct Begun {
    at: Instant,
    measurement: Measurement,
    timings: Timings,
    steps: u64,
    next_status: Instant,
}

impl<'a> Monitor<'a> {
    pub(super) fn new(
        scenario: &'a Scenario,
        progress: Option<RunProgress>,
        live: Option<Publisher>,
    ) -> Self {
        Self { scenario, progress, live, begun: None }
    }
}

impl Begun {
    fn new(scenario: &Scenario, clock: ClockName, signals: &SignalTable) -> Self {
        let run = &scenario.run;
        let (period_s, steps) = (run.control_period_s(), run.steps());
        let plan = Plan { period_s, steps, reference: Some(&scenario.reference), signals };
        let at = Instant::now();
        Self {
            at,
            measurement: Measurement::of_run(&plan, scenario.expectations.iter().map(Expectation::query)),
            timings: Timings::new(clock, run.control_period_us, run.warm_up_steps.into()),
            steps: 0,
            next_status: at,
        }
    }

    fn push(&mut self, step: &Step, mode: RunMode) {
        self.steps += 1;
        self.timings.push(&step.timing);
        self.measurement.push(&step.measured(mode));
    }
}

impl Begun {
    fn simulated_s(&self, scenario: &Scenario) -> f64 {
        self.steps as f64 * scenario.run.control_period_s()
    }

    /// Simulated time per wall-clock time.
    fn rate(&self, scenario: &Scenario, now: Instant) -> f64 {
        self.simulated_s(scenario) / (now - self.at).as_secs_f64()
    }

    fn state(&self, scenario: &Scenario, now: Instant) -> (SoFar, Status) {
        let timing = self.timings.report(Vec::new());
        let so_far = SoFar::new(scenario, &self.measurement.metrics(), &timing, self.steps);
        let status =
            Status::new(&so_far, &timing, self.steps, self.simulated_s(scenario), self.rate(scenario, now));
        (so_far, status)
    }
}

impl StepObserver for Monitor<'_> {
    fn begin(&mut self, start: &RunStart<'_>) -> Result<(), WriteError> {
        if let Some(live) = &mut self.live {
            live.begin(start, SystemTime::now());
        }
        if self.live.is_some() || self.progress.is_some() {
            let mut measured = start.signals.clone();
            if !self.scenario.run.mode.is_hil() {
                measured.plant.clear();
            }
            self.begun = Some(Begun::new(self.scenario, start.clock.name(), &measured));
        }
        Ok(())
    }

    fn step(&mut self, step: &Step) -> Result<(), WriteError> {
        let Some(begun) = &mut self.begun else { return Ok(()) };
        begun.push(step, self.scenario.run.mode);
        let now = Instant::now();
        let is_shown = self.progress.as_mut().is_some_and(|progress| progress.is_due(now));
        let is_published = self.live.is_some() && now >= begun.next_status;
        if is_shown || is_published {
            let (so_far, status) = begun.state(self.scenario, now);
            if let Some(progress) = self.progress.as_ref().filter(|_| is_shown) {
                progress.show(
                    begun.steps,
                    begun.simulated_s(self.scenario),
                    begun.rate(self.scenario, now),
                    &so_far,
                );
            }
            if let Some(live) = self.live.as_mut().filter(|_| is_published) {
                live.show(&status);
                begun.next_status = now + STATUS_INTERVAL;
            }
        }
        if let Some(live) = &mut self.live {
            live.step(step, now);
        }
        Ok(())
    }

    fn event(&mut self, step: u32, event: &Event) -> Result<(), WriteError> {
        if let Some(live) = &mut self.live {
            live.event(step, event);
        }
        Ok(())
    }

    fn stop_asked(&self) -> bool {
        self.live.as_ref().is_some_and(Publisher::stop_asked)
    }
}

impl Drop for Monitor<'_> {
    /// Publishes the last steps, of a failed run too.
    fn drop(&mut self) {
        if let Some(live) = &mut self.live {
            if let Some(begun) = &self.begun {
                live.show(&begun.state(self.scenario, Instant::now()).1);
            }
            live.finish();
        }
    }
}
