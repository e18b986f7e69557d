//! `lashloop soak`: one scenario repeated under rising faults.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use clap::Args;
use lashloop::Bench;
use lashloop::execution::{ExecutionError, OpenDrive};
use lashloop_bench::atomic_file::WriteError;
use lashloop_bench::device::DeviceChoice;
use lashloop_bench::run::{Clock, Event, Outcome, RunError, RunStart, Step, StepObserver};
use lashloop_bench::scenario::Scenario;
use lashloop_bench::supervisor::Supervisor;
use lashloop_bench::verdict::Exit;
use lashloop_campaign::soak::plan;
use lashloop_campaign::soak::resource_usage::{self, Growth};
use lashloop_campaign::soak::tally::Tally;

use lashloop_record::folder::RecordFolder;
use lashloop_record::summary::Summary;
use lashloop_record::window::WindowRecorder;

use super::error::{CliError, system};
use super::options::{DeviceOption, ScenarioOptions};
use super::output::{self, outln};
use super::supervision::start_supervisor;

/// Repeat a scenario while faults of line and encoders rise
///
/// Runs cycle through six levels, from no fault to 1 % of frames damaged. Faults follow from the scenario's seed and the
/// number of the run. Each run opens the drive again; a first run without a step ends the soak. Answer timeout: 100 ms; longest silence: 10 s. Growth limits: 8 MiB
/// and 4 descriptors for the bench after its first cycle, 8 MiB and 2 descriptors for the drive's process within a run.
/// Exit code 1 if a run hangs (no step in --hang-limit), fails or exceeds a growth limit, if its verdict contradicts its counters,
/// or if a damaged frame is not counted; 3 if it is interrupted without any of these.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Duration, such as 90s, 10m or 8h; the last run is completed
    #[arg(long = "for", value_name = "TIME", value_parser = duration)]
    lasts: Duration,

    #[command(flatten)]
    drive: DeviceOption,

    #[command(flatten)]
    scenario: ScenarioOptions,

    /// Folder for a record of each run that goes wrong, `run-NUMBER`; other runs leave none
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,

    /// Time of a record before and after the longest silence of the drive, in s; the end of the run if there was none
    #[arg(long, value_name = "S", default_value_t = 5.0, requires = "out", value_parser = positive_s)]
    keep_around: f64,

    /// Replace the records that the folder of --out holds
    #[arg(long, requires = "out")]
    force: bool,

    /// Time without a step after which a run counts as hung and ends the soak, in s
    #[arg(long, value_name = "S", default_value_t = 60.0, value_parser = positive_s)]
    hang_limit: f64,
}

impl Arguments {
    pub(crate) fn run(self, bench: &Bench) -> Result<Exit, CliError> {
        let (scenario, source) = self.scenario.read_with_source(None, bench)?;
        if let Some(folder) = &self.out {
            RecordFolder::check_inside(folder, self.force)?;
            remove_records(folder)?;
        }
        let supervisor = start_supervisor()?;
        let _signals = supervisor.guard_signals();
        let shared = Arc::new(Shared::default());
        let out = self.out.clone();
        watch_for_hangs(Arc::clone(&shared), Duration::from_secs_f64(self.hang_limit), out);
        let started = Instant::now();
        while started.elapsed() < self.lasts && !supervisor.interrupted() {
            let number = shared.tally().runs;
            let plan = plan::scenario(&scenario, number);
            let mut watcher =
                SoakWatcher { shared: &shared, process: None, growth: Growth::default(), step: 0 };
            let begun = Instant::now();
            *shared.window() =
                self.out.as_ref().map(|_| WindowRecorder::new(self.keep_around, source.clone()));
            let (result, summary) = one_run(&plan, &self.drive.device, &supervisor, &mut watcher);
            let window = shared.window().take();
            let (drive, never_stepped) = (watcher.growth, watcher.step == 0);
            let failed_at_once = result.is_err() && never_stepped && !supervisor.interrupted();
            let result = match result {
                // Run 0 has no faults: a repetition would fail alike.
                Err(error) if failed_at_once && number == 0 => return Err(error.into()),
                result => result,
            };
            let bench = resource_usage::read(None).map_err(system("read /proc"))?;
            let mut tally = shared.tally();
            let before = tally.problems.len();
            tally.push(&plan, &result, bench, &drive);
            tally.took = started.elapsed();
            outln!(
                "run {number:<5} level {} seed {:<6} {} in {:.2} s; bench {} KiB, {} descriptors",
                plan::level(number),
                plan.run.seed,
                line_of(&result),
                begun.elapsed().as_secs_f64(),
                bench.rss_kib,
                bench.descriptors
            );
            for problem in &tally.problems[before..] {
                outln!("WRONG {problem}");
            }
            if let (Some(window), Some(folder), true) = (window, &self.out, tally.problems.len() > before) {
                write_record(window, folder, number, summary.as_ref())?;
            }
            drop(tally);
            if failed_at_once {
                thread::sleep(PAUSE);
            }
        }
        let mut tally = shared.tally();
        tally.interrupted |= supervisor.interrupted();
        outln!("");
        outln!("{tally}");
        Ok(tally.verdict().into())
    }
}

/// Before the run after one that had no step: what can't be started is not started as often as possible.
const PAUSE: Duration = Duration::from_secs(1);
const RUN_FOLDER: &str = "run-";

/// Removes the records of an earlier soak: among those of this one they would be wrong.
fn remove_records(folder: &Path) -> Result<(), CliError> {
    let Ok(entries) = fs::read_dir(folder) else { return Ok(()) };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let number = name.to_str().and_then(|name| name.strip_prefix(RUN_FOLDER));
        if number.is_some_and(|number| number.parse::<u64>().is_ok()) && entry.path().is_dir() {
            RecordFolder::claim(&entry.path(), true)?.remove()?;
        }
    }
    Ok(())
}

fn write_record(
    window: WindowRecorder,
    folder: &Path,
    number: u64,
    end: Option<&Summary>,
) -> Result<(), CliError> {
    if !window.has_begun() {
        return Ok(());
    }
    let folder = RecordFolder::claim(&folder.join(format!("{RUN_FOLDER}{number}")), false)?;
    window.write(&folder, end)?;
    outln!("record {}", folder.path().display());
    Ok(())
}

fn one_run(
    scenario: &Scenario,
    choice: &DeviceChoice,
    supervisor: &Supervisor,
    watcher: &mut SoakWatcher<'_>,
) -> (Result<Outcome, ExecutionError>, Option<Summary>) {
    let made = OpenDrive::open(scenario, choice.into(), Clock::Lockstep, supervisor);
    let mut drive = match made {
        Ok(drive) => drive,
        Err(error) => return (Err(error), None),
    };
    watcher.process = drive.device().connection.host.process().map(|process| process.id);
    let result = drive.run(&mut scenario.clone(), vec![watcher], None);
    let summary = result.as_ref().ok().map(|outcome| Summary::new(scenario, drive.device(), outcome));
    (result, summary)
}

fn line_of(result: &Result<Outcome, ExecutionError>) -> String {
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

/// State shared by the runs and the hang detector.
#[derive(Default)]
struct Shared {
    /// Incremented with every step and every run.
    beats: AtomicU64,
    tally: Mutex<Tally>,
    /// The steps of the run that a record of it would have. A hung run can't write them itself.
    window: Mutex<Option<WindowRecorder>>,
}

impl Shared {
    fn tally(&self) -> MutexGuard<'_, Tally> {
        self.beats.fetch_add(1, Ordering::Relaxed);
        self.tally.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn window(&self) -> MutexGuard<'_, Option<WindowRecorder>> {
        self.window.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Ends the program when no step is made. A hung run can't end itself.
fn watch_for_hangs(shared: Arc<Shared>, limit: Duration, out: Option<PathBuf>) {
    thread::spawn(move || {
        let mut last = (0, Instant::now());
        loop {
            thread::sleep(Duration::from_secs(1));
            let beats = shared.beats.load(Ordering::Relaxed);
            if beats != last.0 {
                last = (beats, Instant::now());
            } else if last.1.elapsed() > limit {
                let tally = shared.tally();
                if let (Some(window), Some(folder)) = (shared.window().take(), &out)
                    && let Err(error) = write_record(window, folder, tally.runs, None)
                {
                    output::complain(format_args!("{error}"));
                }
                output::line(format_args!("\n{tally}"));
                let limit_s = limit.as_secs_f64();
                output::complain(format_args!("run {} hangs: no step in {limit_s} s", tally.runs));
                std::process::exit(Exit::Fail as i32);
            }
        }
    });
}

struct SoakWatcher<'a> {
    shared: &'a Shared,
    process: Option<u32>,
    growth: Growth,
    step: u32,
}

/// Steps between two readings of the drive's resources, and before the first: it has allocated what it needs by then.
const STRIDE: u32 = 500;

impl StepObserver for SoakWatcher<'_> {
    fn begin(&mut self, start: &RunStart<'_>) -> Result<(), WriteError> {
        self.shared.window().as_mut().map_or(Ok(()), |window| window.begin(start))
    }

    fn step(&mut self, step: &Step) -> Result<(), WriteError> {
        self.shared.beats.fetch_add(1, Ordering::Relaxed);
        self.shared.window().as_mut().map_or(Ok(()), |window| window.step(step))?;
        self.step += 1;
        if self.step.is_multiple_of(STRIDE)
            && let Some(process) = self.process
            && let Ok(held) = resource_usage::read(Some(process))
        {
            // If the process has ended, the link reports the error.
            self.growth.push(held);
        }
        Ok(())
    }

    fn event(&mut self, step: u32, event: &Event) -> Result<(), WriteError> {
        self.shared.window().as_mut().map_or(Ok(()), |window| window.event(step, event))
    }

    fn failed(&mut self, error: &RunError) {
        self.shared.window().iter_mut().for_each(|window| window.failed(error));
    }
}

fn positive_s(text: &str) -> Result<f64, String> {
    let time_s = text.parse().map_err(|_| format!("{text:?} isn't a number"))?;
    if (1e-3..=3600.0).contains(&time_s) {
        Ok(time_s)
    } else {
        Err("it must be from 0.001 s to 3600 s".to_owned())
    }
}

/// Parses a duration as a number and its unit.
fn duration(text: &str) -> Result<Duration, String> {
    let (number, seconds) = match text.char_indices().next_back() {
        Some((at, 's')) => (&text[..at], 1.0),
        Some((at, 'm')) => (&text[..at], 60.0),
        Some((at, 'h')) => (&text[..at], 3600.0),
        _ => (text, f64::NAN),
    };
    let time_s = number.parse::<f64>().map_or(f64::NAN, |number| number * seconds);
    // Zero, or more than a week, is a typing error.
    if time_s > 0.0 && time_s <= 7.0 * 24.0 * 3600.0 {
        Ok(Duration::from_secs_f64(time_s))
    } else {
        Err("it must be a number with its unit, s, m or h, more than 0 and at most 168h".to_owned())
    }
}
