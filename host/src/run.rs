//! One run in memory: a scenario and a device in, an outcome out.

use lashloop_bench::device::DeviceChoice;
use lashloop_bench::scenario::Scenario;
use lashloop_bench::supervisor::Supervisor;
use lashloop_record::columns::Columns;

use crate::error::Error;
use crate::execution::Execution;
use crate::outcome::Outcome;

/// Runs a scenario on a device in lockstep and keeps every signal in memory.
///
/// A process that the device needs is started for this run and ends with it. A process of a killed program ends by itself
/// once its line closes; only the command line can tie it to the program.
///
/// # Errors
/// The scenario doesn't fit the drive, or drive, link or plant failed. A missed expectation is a verdict.
pub fn run(scenario: &Scenario, device: &DeviceChoice) -> Result<Outcome, Error> {
    let supervisor = Supervisor::without_signals(None).map_err(Error::Thread)?;
    let mut signals = Columns::default();
    let made = Execution::new(scenario.clone(), device.into()).watch(&mut signals).run(&supervisor)?;
    Ok(Outcome::new(made.outcome, signals))
}
