//! A drive train behind a device: a motion is a run.

use std::io;
use std::path::Path;

use lashloop_bench::atomic_file::WriteError;
use lashloop_bench::device::Device;
use lashloop_bench::run::{End, Outcome, RunStart, Step, StepObserver};
use lashloop_bench::scenario::{RunMode, Scenario, ScenarioErrors};
use lashloop_identify::electrical::StageTrip;
use lashloop_identify::excitation::Exceeded;
use lashloop_identify::excitation::{DriveTrain, Guard, Halt, Made, Noisy, Peaks, PlannedMotion};
use lashloop_identify::{Direction, Held, Instruments, Series, SeriesError};
use lashloop_record::columns::Columns;
use lashloop_record::writer::RecordWriter;

use super::scenario;
use super::trip::trip;
use crate::identify::record::{NoSeries, Reading, counts, directions_in_force, series};
use lashloop::execution::{ExecutionError, OpenDrive};

/// Why a motion could not be made.
#[derive(Debug, thiserror::Error)]
pub enum MotionError {
    #[error(transparent)]
    Scenario(#[from] ScenarioErrors),
    #[error(transparent)]
    Run(#[from] ExecutionError),
    /// The drive or the user ended it.
    #[error("{motion}: {end}; the torque is off")]
    Ended { motion: String, end: String },
    /// Few samples would remain: jitter would end the ramp at once.
    #[error(
        "{motion}: {noisy}; state it by --encoder-noise {:.0}, or find what disturbs the wires",
        noisy.shown_counts.ceil()
    )]
    Noisy { motion: String, noisy: Noisy },
    /// A limit is reached before a motion shows anything.
    #[error(
        "{motion}: {exceeded} within {} samples; the torque is off; wait until the load is at rest, bring it back to where it may move \
         in both directions, or raise the limit",
        Series::SAMPLES_MIN
    )]
    Exceeded { motion: String, exceeded: Exceeded },
    #[error("{motion}: {source}")]
    Series { motion: String, source: NoSeries },
    #[error("{}: can't be written: {source}", path.display())]
    Table { path: std::path::PathBuf, source: io::Error },
    #[error(transparent)]
    Record(RecordError),
}

/// A record that could not be written.
#[derive(Debug, thiserror::Error)]
#[error(transparent)]
pub struct RecordError(#[from] pub Box<dyn std::error::Error + Send + Sync>);

/// A run that was made, for its record.
pub struct RunRecord<'a> {
    pub name: &'a str,
    pub scenario: &'a Scenario,
    pub device: &'a Device,
    pub outcome: &'a Outcome,
    /// What has recorded it.
    pub writer: Option<RecordWriter>,
    /// Why the guard ended it early.
    pub halt: Option<Halt>,
    /// The torque that it began under, if it was held.
    pub held: Option<Held>,
}

/// Motions as runs on a device.
pub struct OnDevice<'a> {
    /// The scenario of a motion with these settings.
    pub scenario: &'a dyn Fn(&[String]) -> Result<Scenario, ScenarioErrors>,
    /// The drive of all motions: in bench mode each motion starts where the one before has ended, and the encoders count on
    /// from the power-up.
    pub drive: OpenDrive<'a>,
    /// The mode of all motions: in HIL mode each starts at `[plant.initial]`.
    pub mode: RunMode,
    pub instruments: Instruments,
    pub period_s: f64,
    /// Folder for the tables of torques.
    pub folder: &'a Path,
    /// What records the run of this name; `None` for no record.
    pub writer: &'a dyn Fn(&str) -> Result<Option<RecordWriter>, RecordError>,
    /// Called with every run, before the next motion.
    pub record: &'a mut dyn FnMut(RunRecord<'_>) -> Result<(), RecordError>,
}

impl DriveTrain for OnDevice<'_> {
    type Error = MotionError;

    fn make(&mut self, motion: &PlannedMotion, guard: Guard) -> Result<Option<Made>, MotionError> {
        let table = self.folder.join(format!("{}.csv", motion.name));
        let settings = scenario::motion(&motion.torque_nm, self.period_s, &table)
            .map_err(|source| MotionError::Table { path: table.clone(), source })?;
        let mut scenario = (self.scenario)(&settings)?;
        scenario::explain_twist(&mut scenario, motion.twist_rad);
        let Some(ran) = self.run(&motion.name, motion.held, scenario, guard)? else { return Ok(None) };
        if ran.halt.is_none() && ran.end != End::Complete {
            return Err(MotionError::Ended { motion: motion.name.clone(), end: ran.end.to_string() });
        }
        let motion = motion.name.clone();
        let series = match (series(&ran.columns, &self.instruments, ran.mode, ran.in_force), ran.halt) {
            (Ok(series), _) => series,
            (Err(NoSeries::Series(SeriesError::Short { .. })), Some(Halt::Exceeded(exceeded))) => {
                return Err(MotionError::Exceeded { motion, exceeded });
            }
            (Err(source), _) => return Err(MotionError::Series { motion, source }),
        };
        Ok(Some(Made { series, halt: ran.halt, peaks: ran.peaks }))
    }

    fn starts_anew(&self) -> bool {
        self.mode.is_hil()
    }
}

/// A run that was made.
pub(super) struct Ran {
    pub(super) columns: Columns,
    pub(super) end: End,
    pub(super) halt: Option<Halt>,
    peaks: Peaks,
    mode: RunMode,
    in_force: [Direction; 2],
}

impl OnDevice<'_> {
    /// Makes the run of this name and records it; `None` if the drive train was not at rest.
    pub(super) fn run(
        &mut self,
        name: &str,
        held: Option<Held>,
        mut scenario: Scenario,
        guard: Guard,
    ) -> Result<Option<Ran>, MotionError> {
        let instruments = self.instruments;
        let (columns, in_force) = (Columns::default(), [Direction::Forward; 2]);
        let (mode, readings) = (scenario.run.mode, Default::default());
        let mut watch = Watch { columns, guard, halt: None, mode, readings, in_force, instruments };
        let mut writer = (self.writer)(name).map_err(MotionError::Record)?;
        let outcome = self.drive.run(&mut scenario, vec![&mut watch], writer.as_mut())?;
        let Watch { columns, guard, halt, in_force, .. } = watch;
        // At the start of a run the drive doesn't know the speed yet, so a motor that still turns contradicts its voltage.
        let turns = guard.awaits_torque() && trip(&outcome.end) == Some(StageTrip::Sensor);
        let noisy = halt.and_then(|it| if let Halt::Noisy(noisy) = it { Some(noisy) } else { None });
        if halt == Some(Halt::NotAtRest) || turns || noisy.is_some() {
            let discarded = writer.map_or(Ok(()), RecordWriter::discard);
            discarded.map_err(|error| MotionError::Record(RecordError(Box::new(error))))?;
            return noisy
                .map_or(Ok(None), |noisy| Err(MotionError::Noisy { motion: name.to_owned(), noisy }));
        }
        let device = self.drive.device();
        let record = RunRecord { name, scenario: &scenario, device, outcome: &outcome, writer, halt, held };
        (self.record)(record).map_err(MotionError::Record)?;
        Ok(Some(Ran { columns, end: outcome.end, halt, peaks: guard.peaks(), mode, in_force }))
    }
}

/// Keeps the columns and gives every step to the guard. A halt ends the run within two periods: a step is complete only
/// with the telemetry after it.
struct Watch {
    columns: Columns,
    guard: Guard,
    halt: Option<Halt>,
    mode: RunMode,
    /// Of motor and load.
    readings: [Reading; 2],
    /// Directions that the drive has in force. Guard and series count as the encoders are wired.
    in_force: [Direction; 2],
    instruments: Instruments,
}

impl StepObserver for Watch {
    fn begin(&mut self, start: &RunStart<'_>) -> Result<(), WriteError> {
        let session = &start.device.session;
        self.in_force = directions_in_force(start.scenario.run.mode, |name| {
            let parameter = session.parameter(name)?;
            parameter.choice(session.in_force(parameter)).map(str::to_owned)
        });
        self.columns.begin(start)
    }

    fn step(&mut self, step: &Step) -> Result<(), WriteError> {
        self.columns.step(step)?;
        if self.halt.is_none() {
            let Instruments { motor_counts_per_rev, load_counts_per_rev, .. } = self.instruments;
            let sent = step.sample.filter(|_| self.mode.is_hil());
            let sent = sent.map(|it| [it.motor_counts, it.load_counts].map(|it| i64::from(it.get())));
            let positions = [step.row.motor_position_rad, step.row.load_position_rad];
            let counts_per_rev = [motor_counts_per_rev, load_counts_per_rev];
            let [motor, load] = [0, 1].map(|at| {
                let of_position = counts(positions[at], counts_per_rev[at]);
                self.in_force[at].sign() * self.readings[at].next(sent.map(|it| it[at]), of_position)
            });
            self.halt = self.guard.check(motor, load);
        }
        Ok(())
    }

    fn stop_asked(&self) -> bool {
        self.halt.is_some()
    }
}
