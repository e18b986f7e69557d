//! A run as a value: scenario, place, clock, record and watchers.
//!
//! A run is an [`Execution`], or one of several of an [`OpenDrive`], so what holds for one holds for all: a signal of the user
//! ends it, and on a rig the limits of the rig apply.
//!
//! | module | has |
//! |---|---|
//! | `place` | [`Place`]: a device, or a rig that this program uses alone |
//! | `drive` | [`OpenDrive`]: the drive of a place, opened; it makes one run or several |
//! | `error` | why there is no run |

mod drive;
mod error;
mod place;

pub use drive::{Middleware, OpenDrive};
pub use error::ExecutionError;
pub use place::Place;

use lashloop_bench::atomic_file::WriteError;
use lashloop_bench::device::Device;
use lashloop_bench::run::{self, Clock, DeviceUnderTest, StepObserver};
use lashloop_bench::scenario::Scenario;
use lashloop_bench::supervisor::Supervisor;
use lashloop_record::scope;
use lashloop_record::summary::Summary;
use lashloop_record::writer::RecordWriter;

/// One run of a scenario. Without further calls it is in lockstep, unwatched, and leaves no record.
#[must_use]
pub struct Execution<'a> {
    scenario: Scenario,
    place: Place<'a>,
    clock: Clock,
    middleware: Option<Middleware<'a>>,
    tools: Tools<'a>,
}

/// What receives the steps of a run.
#[derive(Default)]
struct Tools<'a> {
    watchers: Vec<&'a mut dyn StepObserver>,
    record: Option<RecordWriter>,
}

impl<'a> Execution<'a> {
    /// A run of this scenario at this place.
    pub fn new(scenario: Scenario, place: Place<'a>) -> Self {
        Self { scenario, place, clock: Clock::Lockstep, middleware: None, tools: Tools::default() }
    }

    /// Paces the run by this clock.
    pub fn clock(self, clock: Clock) -> Self {
        Self { clock, ..self }
    }

    /// Passes every step to this observer, which may end the run.
    pub fn watch(mut self, watcher: &'a mut dyn StepObserver) -> Self {
        self.tools.watchers.push(watcher);
        self
    }

    /// Writes this record. It receives each step after all watchers.
    pub fn record(mut self, record: impl Into<Option<RecordWriter>>) -> Self {
        self.tools.record = record.into();
        self
    }

    /// Wraps the link to the drive.
    pub fn middleware(self, middleware: impl Into<Option<Middleware<'a>>>) -> Self {
        Self { middleware: middleware.into(), ..self }
    }

    /// Opens the drive. On a rig, the scenario keeps its limits from here on.
    ///
    /// # Errors
    /// The scenario exceeds the rig, or the drive can't be reached.
    pub fn open(self, supervisor: &'a Supervisor) -> Result<Ready<'a>, ExecutionError> {
        let Self { scenario, place, clock, middleware, tools } = self;
        let middleware = middleware.unwrap_or_else(|| Box::new(|link| link));
        let drive = OpenDrive::open_through(&scenario, place, clock, supervisor, middleware)?;
        Ok(Ready { scenario, drive, tools })
    }

    /// Opens the drive and makes the run.
    ///
    /// # Errors
    /// As [`open`](Self::open) and [`Ready::run`].
    pub fn run(self, supervisor: &'a Supervisor) -> Result<Made, ExecutionError> {
        self.open(supervisor)?.run()
    }
}

/// A run whose drive is open.
#[must_use]
pub struct Ready<'a> {
    scenario: Scenario,
    drive: OpenDrive<'a>,
    tools: Tools<'a>,
}

impl Ready<'_> {
    /// The drive.
    #[must_use]
    pub fn device(&self) -> &Device {
        self.drive.device()
    }

    /// Makes the run.
    ///
    /// # Errors
    /// The scenario doesn't fit the drive or its rig; drive, link, plant or record failed.
    pub fn run(self) -> Result<Made, ExecutionError> {
        let Self { mut scenario, mut drive, tools: Tools { mut watchers, mut record } } = self;
        let watchers = watchers.iter_mut().map(|it| &mut **it as &mut dyn StepObserver).collect();
        let outcome = drive.run(&mut scenario, watchers, record.as_mut())?;
        Ok(Made { scenario, outcome, drive: drive.end(), record })
    }
}

/// A run that was made. [`finish`](Self::finish) completes its record; dropped, it leaves one without a summary.
#[must_use]
pub struct Made {
    /// The scenario as it ran.
    pub scenario: Scenario,
    /// Its outcome. What changes before [`finish`](Self::finish) is recorded so.
    pub outcome: run::Outcome,
    drive: DeviceUnderTest,
    record: Option<RecordWriter>,
}

impl Made {
    /// The drive.
    #[must_use]
    pub fn device(&self) -> &Device {
        &self.drive.device
    }

    /// Closes the link and completes the record.
    ///
    /// # Errors
    /// The record can't be written.
    pub fn finish(self) -> Result<Finished, WriteError> {
        let Self { scenario, outcome, drive, record } = self;
        let summary = Summary::new(&scenario, &drive.device, &outcome);
        drop(drive);
        if let Some(record) = record {
            if let Some(captured) = &outcome.scope {
                record.write_scope(&scope::columns(captured, &scenario))?;
            }
            record.finish(&summary)?;
        }
        Ok(Finished { scenario, outcome, summary })
    }
}

/// A run with its verdict, recorded if that was asked for.
pub struct Finished {
    /// The scenario as it ran.
    pub scenario: Scenario,
    /// What the bench counted and measured.
    pub outcome: run::Outcome,
    /// The summary, as a record has it.
    pub summary: Summary,
}
