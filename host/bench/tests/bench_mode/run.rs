//! A run of a scenario, with its steps.

use std::path::PathBuf;

use lashloop_bench::atomic_file::WriteError;
use lashloop_bench::device::kinds::in_process::InProcessDrive;
use lashloop_bench::device::{DeviceChoice, DeviceError, DeviceKind, Opened};
use lashloop_bench::run::{Clock, DeviceUnderTest, Outcome, RunError, Step, StepObserver, run};
use lashloop_bench::scenario::{Override, Scenario};
use lashloop_bench::supervisor::Supervisor;
use lashloop_bench::timing::ClockName;

use crate::line::Line;

/// The compensation on the smooth plant.
pub(crate) const SMOOTH_AFTER: &str = include_str!("../../../../scenarios/bench-smooth-after.toml");
/// The paper's runs, before and after compensation.
pub(crate) const PAPER: [&str; 4] = [
    include_str!("../../../../scenarios/bench-smooth-before.toml"),
    SMOOTH_AFTER,
    include_str!("../../../../scenarios/bench-friction-before.toml"),
    include_str!("../../../../scenarios/bench-friction-after.toml"),
];

pub(crate) fn read(text: &str, overrides: &[Override]) -> Result<Scenario, String> {
    Scenario::from_str("x.toml", text, overrides).map_err(|errors| errors.to_string())
}

pub(crate) fn scenario(text: &str, settings: &[&str]) -> Scenario {
    let settings: Vec<_> = settings.iter().map(|it| Override::Set((*it).to_owned())).collect();
    read(text, &settings).unwrap_or_else(|errors| panic!("{errors}"))
}

/// A run with its steps.
#[derive(Debug)]
pub(crate) struct Recorded {
    pub(crate) outcome: Outcome,
    pub(crate) steps: Vec<Step>,
}

/// Runs on the drive in this process, through a line.
pub(crate) fn on_pins(scenario: &Scenario, line: Line) -> Result<Recorded, RunError> {
    on(scenario, &"inproc".parse().expect("a device"), line)
}

/// The drive in this process without a plant behind its pins: it has no pins at all.
#[derive(Debug)]
struct Pinless;

impl DeviceKind for Pinless {
    fn name(&self) -> String {
        "pinless".to_owned()
    }

    fn open(&self, baud: u32, supervisor: &Supervisor) -> Result<Opened, DeviceError> {
        InProcessDrive::<lashloop_firmware::Laws>::default().open(baud, supervisor)
    }

    fn keeps_bench_clock(&self, clock: ClockName) -> bool {
        clock == ClockName::Lockstep
    }
}

/// Runs on a drive without bench mode.
pub(crate) fn without_pins(scenario: &Scenario) -> Result<Recorded, RunError> {
    on(scenario, &Pinless.into(), Line::default())
}

fn on(scenario: &Scenario, choice: &DeviceChoice, line: Line) -> Result<Recorded, RunError> {
    let supervisor = Supervisor::without_signals(None::<PathBuf>).expect("a supervisor");
    let mut device =
        DeviceUnderTest::open(scenario, choice, ClockName::Lockstep, &supervisor, |link| line.around(link))?;
    let mut steps = Steps(Vec::new());
    let outcome = run(scenario, &mut device, Clock::Lockstep, &mut steps)?;
    Ok(Recorded { outcome, steps: steps.0 })
}

struct Steps(Vec<Step>);

impl StepObserver for Steps {
    fn step(&mut self, step: &Step) -> Result<(), WriteError> {
        self.0.push(step.clone());
        Ok(())
    }
}
