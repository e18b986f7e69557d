//! The end of a commissioning: what the law makes of the estimates, and the reach that confirms them on the drive.

use std::path::Path;

use lashloop::Bench;
use lashloop::margins::rest_rad;
use lashloop_bench::scenario::{Override, Scenario};
use lashloop_bench::supervisor::Supervisor;
use lashloop_bench::verdict::Exit;
use lashloop_hardware::identify::reach::{self, FirstReach};
use toml_edit::DocumentMut;

use super::error::{CliError, system};
use super::margins;
use super::options::plants;
use super::output::{outln, write_file};

/// Keys of a simulated plant.
const SIMULATED: [&str; 3] = ["torque_delay_us", "load_torque", "wear"];
/// Traps that a reach may have. A file must not name one that it doesn't have.
const TRAPS: [&str; 3] = ["start", "mismatch", "large-angle"];

/// Simulates the reach on the estimated plant, prints what it shows, and writes the reach for the drive into the folder.
pub(super) fn of(
    reach: &FirstReach<'_>,
    simulated: &Scenario,
    of_drive: &Scenario,
    folder: Option<&Path>,
    supervisor: &Supervisor,
    bench: &Bench,
) -> Result<Exit, CliError> {
    let distance_rad = reach.distance_rad();
    outln!("\nfirst reach          {distance_rad} rad with {}, on the estimated plant", reach::LAW);
    let Some(found) = margins::of(bench, supervisor, simulated)? else { return Ok(Exit::Invalid) };
    let Some(folder) = folder else { return Ok(Exit::Pass) };
    let Some(settle_time_s) = found.settle_time_s else {
        outln!("no {}: there is nothing that the drive could confirm", reach::REACH_FILE);
        return Ok(Exit::Pass);
    };
    let file = folder.join(reach::REACH_FILE);
    write_file(&file, &text(of_drive, &reach::expectations(settle_time_s, rest_rad(simulated)), bench)?)?;
    outln!("{}", file.display());
    if !reach.of.mode.is_hil() {
        outln!(
            "before that run: power the drive off and on where its load stands, and put the directions above into the rig file, if \
             there is one; the load then moves by {distance_rad} rad"
        );
    }
    Ok(Exit::Pass)
}

/// The scenario with its expectations, as a file that is read without options.
fn text(scenario: &Scenario, expectations: &str, bench: &Bench) -> Result<String, CliError> {
    let toml = |scenario: &Scenario| {
        let text = scenario.to_toml().map_err(system("write the scenario as TOML"))?;
        let mut document: DocumentMut = text.parse().map_err(system("read the scenario as TOML"))?;
        if let Some(plant) = document["plant"].as_table_mut().filter(|_| !scenario.run.mode.is_hil()) {
            // What is at the pins has them, and a file of bench mode must not, not even at their defaults.
            SIMULATED.iter().for_each(|key| drop(plant.remove(key)));
        }
        Ok::<_, CliError>(document.to_string())
    };
    let read = |text: &str, settings: &[String]| {
        let settings: Vec<_> = settings.iter().cloned().map(Override::Set).collect();
        Scenario::from_str_with(&scenario.name, text, &settings, &plants(bench))
    };
    let whole = toml(scenario)?;
    let mut last = None;
    for chosen in 0..1 << TRAPS.len() {
        let meant: Vec<_> = (0..TRAPS.len()).filter(|at| chosen >> at & 1 == 1).map(|at| TRAPS[at]).collect();
        match read(&whole, &[expectations.to_owned(), format!("meant={meant:?}")]) {
            Ok(scenario) => {
                let text = toml(&scenario)?;
                match read(&text, &[]) {
                    Ok(_) => return Ok(text),
                    Err(errors) => last = Some(errors),
                }
            }
            Err(errors) => last = Some(errors),
        }
    }
    Err(last.map_or_else(|| system("write the first reach")("no traps were tried"), CliError::Scenario))
}
