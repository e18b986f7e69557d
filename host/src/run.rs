//! One run in memory: a scenario and a device in, an outcome out.

use lashloop_bench::device::DeviceChoice;
use lashloop_bench::run::{Clock, DeviceUnderTest};
use lashloop_bench::scenario::Scenario;
use lashloop_bench::supervisor::Supervisor;
use lashloop_bench::timing::ClockName;
use lashloop_record::columns::Columns;

use crate::error::Error;
use crate::outcome::Outcome;

/// Runs a scenario on a device in lockstep and keeps every signal in memory.
///
/// A process that the device needs is started for this run and ends with it. A process of a killed program ends by itself
/// once its line closes; only the command line can tie it to the program.
///
/// # Errors
/// The scenario does not fit the drive, or drive, link or plant failed. A missed expectation isn't an error but a verdict.
pub fn run(scenario: &Scenario, device: &DeviceChoice) -> Result<Outcome, Error> {
    let supervisor = Supervisor::without_signals(None).map_err(Error::Thread)?;
    let opened = DeviceUnderTest::open(scenario, device, ClockName::Lockstep, &supervisor, |link| link);
    let mut device = opened.map_err(lashloop_bench::run::RunError::from)?;
    let mut signals = Columns::default();
    let run = lashloop_bench::run::run(scenario, &mut device, Clock::Lockstep, &mut signals)?;
    Ok(Outcome::new(run, signals))
}
