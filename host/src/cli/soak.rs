//! `lashloop soak`: a scenario over and over, with more and more going wrong.

use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use clap::Args;
use lashloop::soak::plan;
use lashloop::soak::resource_usage::{self, Growth};
use lashloop::soak::tally::Tally;
use lashloop_bench::atomic_file::WriteError;
use lashloop_bench::device::DeviceChoice;
use lashloop_bench::run::DeviceUnderTest;
use lashloop_bench::run::{self, Clock, Outcome, RunError, Step, StepObserver};
use lashloop_bench::scenario::{Override, Scenario};
use lashloop_bench::supervisor::Supervisor;
use lashloop_bench::verdict::Exit;

use super::error::CliError;
use super::{output, start_supervisor};

/// A run that makes no step for so long hangs.
const HANG_LIMIT: Duration = Duration::from_secs(60);

/// Run a scenario over and over while faults of line and encoders rise, and watch bench and drive.
///
/// Runs go through six levels, from no fault to 1 % of frames damaged, and begin anew; faults are drawn from the seed of the
/// scenario and the number of the run. Each run opens the drive anew. The bench may grow by 8 MiB and 4 descriptors from the
/// first round on, a drive's process by 8 MiB and 2 descriptors within a run. Ends with 0, or with 1 if a run hung (no step
/// in 60 s), failed, grew, had a verdict that its own figures belie, or lost frames uncounted. Answers are waited for
/// for 100 ms, and a silence may last for 10 s.
#[derive(Args)]
pub(crate) struct Arguments {
    /// The scenario
    scenario: PathBuf,

    /// For how long: 90s, 10m or 8h. The run that is under way then is finished
    #[arg(long = "for", value_name = "TIME", value_parser = duration)]
    lasts: Duration,

    /// The drive, as for `run`
    #[arg(long, default_value = "native", value_name = "DEVICE")]
    device: DeviceChoice,

    /// Another value for a key, as for `run`
    #[arg(long, value_name = "SECTION.KEY=VALUE")]
    set: Vec<String>,
}

impl Arguments {
    pub(crate) fn run(self) -> Result<Exit, CliError> {
        let overrides: Vec<_> = self.set.into_iter().map(Override::Set).collect();
        let scenario = Scenario::from_file(&self.scenario, &overrides)?;
        let supervisor = start_supervisor()?;
        let _heed = supervisor.guard_signals();
        let shared = Arc::new(Shared::default());
        watch_for_hangs(Arc::clone(&shared));
        let started = Instant::now();
        while started.elapsed() < self.lasts && !supervisor.interrupted() {
            let number = shared.tally().runs();
            let plan = plan::scenario(&scenario, number);
            let mut watcher = SoakWatcher {
                supervisor: &supervisor,
                shared: &shared,
                process: None,
                growth: Growth::default(),
                step: 0,
            };
            let begun = Instant::now();
            let result = one_run(&plan, &self.device, &supervisor, &mut watcher);
            let drive = watcher.growth;
            let bench = resource_usage::look(None)
                .map_err(|source| CliError::System { what: "look at /proc", source })?;
            let mut tally = shared.tally();
            let before = tally.problems.len();
            tally.push(&plan, &result, bench, &drive);
            tally.took = started.elapsed();
            say!(
                "run {number:<5} level {} seed {:<6} {} in {:.2} s; bench {} KiB, {} descriptors",
                plan::level(number),
                plan.run.seed,
                line_of(&result),
                begun.elapsed().as_secs_f64(),
                bench.rss_kib,
                bench.descriptors
            );
            for problem in &tally.problems[before..] {
                say!("WRONG {problem}");
            }
        }
        let tally = shared.tally();
        say!("");
        say!("{tally}");
        Ok(if tally.problems.is_empty() { Exit::Pass } else { Exit::Fail })
    }
}

fn one_run(
    scenario: &Scenario,
    choice: &DeviceChoice,
    supervisor: &Supervisor,
    watcher: &mut SoakWatcher<'_>,
) -> Result<Outcome, RunError> {
    let mut device = DeviceUnderTest::open(scenario, choice, supervisor, |link| link)?;
    watcher.process = device.device.process().map(lashloop_bench::supervisor::Process::id);
    run::run(scenario, &mut device, Clock::Lockstep, watcher)
}

fn line_of(result: &Result<Outcome, RunError>) -> String {
    match result {
        Ok(outcome) => {
            let link = &outcome.link;
            let damaged = link.crc_errors + link.damaged_at_drive;
            let verdict = outcome.judgement.verdict;
            format!("{verdict:<7} {} steps, {} lost, {damaged} damaged", outcome.steps, link.lost)
        }
        Err(_) => "no verdict".to_owned(),
    }
}

/// What the runs and the thread that looks for hangs share.
#[derive(Default)]
struct Shared {
    /// Goes on with every step and every run.
    beats: AtomicU64,
    tally: Mutex<Tally>,
}

impl Shared {
    fn tally(&self) -> MutexGuard<'_, Tally> {
        self.beats.fetch_add(1, Ordering::Relaxed);
        self.tally.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Ends the soak when no step is made: nobody else could.
fn watch_for_hangs(shared: Arc<Shared>) {
    thread::spawn(move || {
        let mut last = (0, Instant::now());
        loop {
            thread::sleep(Duration::from_secs(1));
            let beats = shared.beats.load(Ordering::Relaxed);
            if beats != last.0 {
                last = (beats, Instant::now());
            } else if last.1.elapsed() > HANG_LIMIT {
                let tally = shared.tally();
                output::line(format_args!("\n{tally}"));
                let limit_s = HANG_LIMIT.as_secs();
                output::error_line(format_args!(
                    "lashloop: run {} hangs: no step in {limit_s} s",
                    tally.runs()
                ));
                std::process::exit(Exit::Fail as i32);
            }
        }
    });
}

struct SoakWatcher<'a> {
    supervisor: &'a Supervisor,
    shared: &'a Shared,
    process: Option<u32>,
    growth: Growth,
    step: u32,
}

/// Steps between two looks at the drive's process, and before the first: it takes what it needs by then.
const STRIDE: u32 = 500;

impl StepObserver for SoakWatcher<'_> {
    fn step(&mut self, _: &Step) -> Result<(), WriteError> {
        self.shared.beats.fetch_add(1, Ordering::Relaxed);
        self.step += 1;
        if self.step.is_multiple_of(STRIDE)
            && let Some(process) = self.process
            && let Ok(held) = resource_usage::look(Some(process))
        {
            // A process that is gone is what the line is about to tell.
            self.growth.push(held);
        }
        Ok(())
    }

    fn stop_asked(&self) -> bool {
        self.supervisor.interrupted()
    }
}

/// A time as a number and its unit.
fn duration(text: &str) -> Result<Duration, String> {
    let (number, seconds) = match text.char_indices().next_back() {
        Some((at, 's')) => (&text[..at], 1.0),
        Some((at, 'm')) => (&text[..at], 60.0),
        Some((at, 'h')) => (&text[..at], 3600.0),
        _ => (text, f64::NAN),
    };
    let time_s = number.parse::<f64>().map_or(f64::NAN, |number| number * seconds);
    // A week and more is a typing error, and so is nothing.
    if time_s > 0.0 && time_s <= 7.0 * 24.0 * 3600.0 {
        Ok(Duration::from_secs_f64(time_s))
    } else {
        Err("it must be a number with its unit, s, m or h, more than 0 and at most 168h".to_owned())
    }
}
