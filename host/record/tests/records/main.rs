//! Records of runs in this process, written and read.

mod container;
mod earlier_format;
mod interrupted;
mod large;
mod repeated;
mod size;
mod whole;
mod window;

use std::path::{Path, PathBuf};

use lashloop_bench::run::{Clock, DeviceUnderTest, Observers, Outcome, RunError, StepObserver, run};
use lashloop_bench::scenario::{Override, Scenario};
use lashloop_bench::supervisor::Supervisor;
use lashloop_bench::timing::ClockName;
use lashloop_record::columns::Columns;

/// A scenario of the tree with these settings.
fn scenario(name: &str, settings: &[&str]) -> Scenario {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios").join(name);
    let overrides: Vec<_> = settings.iter().map(|it| Override::Set((*it).to_owned())).collect();
    Scenario::from_file(&path, &overrides).expect("a scenario")
}

/// Names of all scenarios of the tree.
fn all_scenarios() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    let files = std::fs::read_dir(folder).expect("scenarios").map(|entry| entry.expect("a file").path());
    files.filter(|path| path.extension().is_some_and(|it| it == "toml")).collect()
}

/// Runs it in this process.
fn run_in_process(scenario: &Scenario, observers: Vec<&mut dyn StepObserver>) -> Result<Outcome, RunError> {
    let supervisor = Supervisor::without_signals(None).expect("a supervisor");
    let choice = "inproc".parse().expect("a device");
    let mut device = DeviceUnderTest::open(scenario, &choice, ClockName::Lockstep, &supervisor, |link| link)?;
    run(scenario, &mut device, Clock::Lockstep, &mut Observers(observers))
}

/// Every column, bit by bit.
fn bits(columns: &Columns) -> Vec<(String, Vec<u64>)> {
    let column = |name: &str| columns.get(name).expect("the column").iter().map(|it| it.to_bits()).collect();
    columns.signals().iter().map(|it| (it.name.to_string(), column(&it.name))).collect()
}
