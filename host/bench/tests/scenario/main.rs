//! Scenarios as a user meets them: valid files, and the messages for invalid ones.

mod backlash_shaft;
mod expectation;
mod fault;
mod file;
mod hostile;
mod keys;
mod messages;
mod overrides;
mod paper;
mod process;
mod sweep;
mod traps;
mod values;

use lashloop_bench::scenario::{Override, Scenario};

/// The shortest scenario there is: everything else has a default.
const SHORTEST: &str = r#"title = "a run"
[run]
duration_s = 2.0
[plant]
model = "smooth"
[controller]
name = "pd"
[reference]
profile = "constant"
position_rad = 0.0
"#;

/// Reads a text as the file `x.toml`.
fn read(text: &str, overrides: &[Override]) -> Result<Scenario, String> {
    Scenario::from_str("x.toml", text, overrides).map_err(|errors| errors.to_string())
}

/// A scenario that was printed, read again with the places of the first one.
fn printed_and_read(scenario: &Scenario) -> Scenario {
    let printed = scenario.to_toml().expect("TOML");
    let mut again = read(&printed, &[]).unwrap_or_else(|errors| panic!("{errors}\n{printed}"));
    again.controller.origin = scenario.controller.origin.clone();
    for (setting, before) in again.controller.parameters.iter_mut().zip(&scenario.controller.parameters) {
        setting.origin = before.origin.clone();
    }
    again
}

/// `--set` with each of these.
fn set<const N: usize>(assignments: [&str; N]) -> [Override; N] {
    assignments.map(|assignment| Override::Set(assignment.to_owned()))
}
