//! The process as a plant.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use lashloop_plant::{Plant, PlantError, PlantValue, PlantValues, Positions, Release, Signal};
use serde::de::DeserializeOwned;
use tempfile::TempDir;

use super::error::ProcessError;
use super::keys::{FILES, FOLDER};
use super::lines::{Lines, NoLine};
use super::messages::{Description, Hello, Report, State, Step, VERSION};
use crate::regular_file::RegularFile;
use crate::supervisor::{Process, Program, Supervisor, find_program};
use lashloop_session::printable;

/// Largest difference between a position of `[plant.initial]` and that of the process, in rad, or relative to positions above
/// 1 rad: single precision passes.
const START_TOLERANCE: f64 = 1e-6;
/// Time that an ended process may take to leave its exit status.
const STATUS_LIMIT: Duration = Duration::from_millis(500);
/// Characters of a malformed line that a message quotes.
const QUOTED: usize = 120;

/// A plant in another process. Dropping it closes the pipes, then ends the process.
pub(super) struct ProcessPlant {
    // The order of the fields is the order in which they are dropped.
    lines: Lines,
    process: Process,
    _supervisor: Supervisor,
    _scratch: Option<TempDir>,
    step_limit: Duration,
    signals: Vec<Signal>,
    state: State,
}

/// What is started, and what it is told.
pub(super) struct Launch<'a> {
    pub(super) program: Program,
    pub(super) settings: Option<&'a PlantValue>,
    /// A folder that is removed once the process has ended.
    pub(super) scratch: Option<TempDir>,
}

impl ProcessPlant {
    /// Starts the process and reads its signals and its initial state.
    pub(super) fn start(
        release: &Release<'_>,
        launch: Launch<'_>,
        bench: Option<PathBuf>,
    ) -> Result<Self, ProcessError> {
        let values = release.values;
        let folder = folder(values, release.folder);
        for file in named_files(values, &folder) {
            RegularFile::open(&file).map_err(|source| ProcessError::File { file, source })?;
        }
        let Launch { program, settings, scratch } = launch;
        let supervisor = Supervisor::without_signals(bench)?;
        let (process, to_process, from_process) = supervisor.spawn_piped_in(&folder, &program)?;
        let mut plant = Self {
            lines: Lines::new(to_process, from_process)?,
            process,
            _supervisor: supervisor,
            _scratch: scratch,
            step_limit: limit(values, "step_timeout_ms")?,
            signals: Vec::new(),
            state: State::default(),
        };
        let hello =
            Hello { lashloop_plant: VERSION, period_s: release.period_s, initial: release.start, settings };
        let line = plant.exchange(&hello, "start_timeout_ms", limit(values, "start_timeout_ms")?)?;
        let description: Description = parse(&line)?;
        if description.lashloop_plant != VERSION {
            return Err(ProcessError::Version { have: description.lashloop_plant, want: VERSION });
        }
        plant.signals = description.signals.into_iter().map(Signal::from).collect();
        plant.take_state(&line)?;
        plant.check_start(release)?;
        Ok(plant)
    }

    /// A process that ignores `[plant.initial]` would be judged from a start that it hasn't.
    fn check_start(&self, release: &Release<'_>) -> Result<(), ProcessError> {
        let State { motor_position_rad, load_position_rad, .. } = self.state;
        let start = &release.start;
        for (key, have, want) in [
            ("motor_position_rad", motor_position_rad, start.motor_position_rad),
            ("load_position_rad", load_position_rad, start.load_position_rad),
        ] {
            if (have - want).abs() > START_TOLERANCE * want.abs().max(1.0) {
                return Err(ProcessError::OtherStart { key, have, want });
            }
        }
        Ok(())
    }

    /// Sends a line and receives one.
    fn exchange(
        &mut self,
        message: &impl serde::Serialize,
        key: &'static str,
        limit: Duration,
    ) -> Result<Vec<u8>, ProcessError> {
        let line = serde_json::to_vec(message).map_err(std::io::Error::from)?;
        let deadline = Instant::now() + limit;
        let answer = self.lines.write(line, deadline).and_then(|()| self.lines.read(deadline));
        answer.map_err(|error| match error {
            NoLine::Closed => ProcessError::Ended { status: self.status(), stderr: self.stderr() },
            NoLine::Late => ProcessError::Silent { limit, key, stderr: self.stderr() },
            NoLine::NotRead => ProcessError::NotRead { limit, key, stderr: self.stderr() },
            NoLine::Interrupted => ProcessError::Interrupted,
            NoLine::TooLong => ProcessError::Malformed {
                line: "...".to_owned(),
                reason: "a line must be shorter than 1 MiB".to_owned(),
            },
        })
    }

    fn take_state(&mut self, line: &[u8]) -> Result<(), ProcessError> {
        let state: State = parse(line)?;
        let (have, want) = (state.values.len(), self.signals.len());
        if have != want {
            return Err(ProcessError::ValueCount { have, want });
        }
        self.state = state;
        Ok(())
    }

    fn status(&self) -> String {
        let status = self.process.ended_within(STATUS_LIMIT);
        status.map(|status| format!(": {status}")).unwrap_or_default()
    }

    fn stderr(&self) -> String {
        let text = self.process.stderr();
        if text.is_empty() { text } else { format!("; it wrote {text:?}") }
    }

    fn advance(&mut self, torque_nm: f64, dt_s: f64) -> Result<(), ProcessError> {
        // The next step would take such a line for its own, and every later step the one before it.
        if let Some(line) = self.lines.arrived() {
            return Err(ProcessError::Unrequested { line: quoted(&line) });
        }
        let line = self.exchange(&Step { torque_nm, dt_s }, "step_timeout_ms", self.step_limit)?;
        self.take_state(&line)
    }
}

impl Plant for ProcessPlant {
    fn signals(&self) -> &[Signal] {
        &self.signals
    }

    fn truth(&self, values: &mut [f64]) {
        values.copy_from_slice(&self.state.values);
    }

    fn positions(&self) -> Positions {
        let State { motor_position_rad, load_position_rad, .. } = self.state;
        Positions { motor_position_rad, load_position_rad }
    }

    fn step(&mut self, torque_nm: f64, dt_s: f64) -> Result<(), PlantError> {
        // JSON has no other numbers.
        if !torque_nm.is_finite() {
            return Err(PlantError::Torque { torque_nm });
        }
        self.advance(torque_nm, dt_s).map_err(PlantError::from)
    }
}

/// The folder in which the program runs, for a scenario in the folder `of_scenario`.
#[must_use]
pub fn folder(values: &PlantValues, of_scenario: &Path) -> PathBuf {
    match values.get(FOLDER) {
        Some(PlantValue::Text(folder)) if !folder.is_empty() => of_scenario.join(folder),
        _ => of_scenario.to_owned(),
    }
}

/// The program, and each argument that is a file: the script of an interpreter is the plant.
pub(super) fn files_of(program: Program, folder: &Path) -> impl Iterator<Item = PathBuf> {
    let arguments = program.arguments.into_iter().map(|it| folder.join(it)).filter(|path| path.is_file());
    [program.program.into()].into_iter().chain(arguments)
}

/// The files that `plant.files` names.
pub(super) fn named_files(values: &PlantValues, folder: &Path) -> Vec<PathBuf> {
    values.texts(FILES).unwrap_or_default().into_iter().map(|name| folder.join(name)).collect()
}

/// The program of `plant.command`.
pub(super) fn program(values: &PlantValues, folder: &Path) -> Result<Program, ProcessError> {
    let start = |reason: &str| ProcessError::Start { reason: reason.to_owned() };
    let words = values.texts("command").map_err(|error| start(&error.to_string()))?;
    let (name, arguments) = words.split_first().ok_or_else(|| start("its command is empty"))?;
    // A path starts at the folder in which the process runs, a name is looked up in PATH.
    let name = if name.contains('/') { folder.join(name) } else { name.into() };
    let found = find_program(&name.to_string_lossy()).map_err(|reason| ProcessError::Start { reason })?;
    Ok(Program {
        name: "the plant",
        program: std::path::absolute(found)?.into(),
        arguments: arguments.iter().map(Into::into).collect(),
        core: None,
    })
}

fn limit(values: &PlantValues, key: &'static str) -> Result<Duration, ProcessError> {
    let milliseconds =
        values.integer(key).map_err(|error| ProcessError::Start { reason: error.to_string() })?;
    Ok(Duration::from_millis(milliseconds))
}

/// The beginning of a line.
fn quoted(line: &[u8]) -> String {
    String::from_utf8_lossy(line).chars().take(QUOTED).collect()
}

fn parse<T: DeserializeOwned>(line: &[u8]) -> Result<T, ProcessError> {
    serde_json::from_slice(line).map_err(|error| {
        if let Ok(Report { error }) = serde_json::from_slice(line) {
            return ProcessError::Reported(printable(&error));
        }
        let text = String::from_utf8_lossy(line);
        let line = quoted(line);
        // What most languages print for such numbers; JSON has none of them.
        let mut words = text.split(|c: char| !c.is_ascii_alphanumeric());
        if words.any(|word| ["nan", "inf", "infinity"].iter().any(|it| word.eq_ignore_ascii_case(it))) {
            return ProcessError::NotFinite { line };
        }
        ProcessError::Malformed { line, reason: error.to_string() }
    })
}
