//! `lashloop paper experiment`: the paper's experiment on a drive in bench mode, next to its simulation.

use std::io::{self, BufRead, Write};
use std::path::{Path, PathBuf};

use clap::Args;
use lashloop::Bench;
use lashloop_bench::device::DeviceChoice;
use lashloop_bench::regular_file;
use lashloop_bench::run::Clock;
use lashloop_bench::run::real_time::RealTime;
use lashloop_bench::scenario::{Override, Scenario};
use lashloop_bench::supervisor::Supervisor;
use lashloop_bench::timing::ClockName;
use lashloop_bench::verdict::{Exit, Verdict};
use lashloop_plant::Plants;
use lashloop_record::folder::RecordFolder;
use lashloop_record::source::{RunSource, command_line, working_directory};
use lashloop_record::writer::RecordWriter;
use merzouki_2005::figures::{
    BeforeAfter, COMPARISON, Compared, Experiment, Run, comparison_figures, comparison_table, file_name, page,
};
use toml_edit::DocumentMut;

use super::history::run_for_figure;
use crate::error::{CliError, system};
use crate::options::{RigOption, plants};
use crate::output::{outln, prepare_folder, warn, write_csv, write_file};
use crate::supervision::start_supervisor;
use lashloop::execution::{OpenDrive, Place};
use lashloop::rig::{Rig, RigError};
use merzouki_2005::scenarios::{BENCH_SCENARIOS, BRIDGE, Source};

const INDEX: &str = "index.html";

/// Run the paper's experiment in bench mode next to its simulation, as a table and figures
///
/// Runs sections 6 and 7 of the paper, before and after compensation, on a drive that reads its own encoders and commands
/// its power stage, and each scenario in HIL mode in this process. Writes figure-07.svg, figure-15.svg to figure-17.svg,
/// and index.html with all of them.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Drive: silicon, inproc, or one on hardware; see `lashloop run --help`
    #[arg(long, default_value = "silicon", value_name = "DEVICE", conflicts_with = "rig")]
    device: DeviceChoice,

    #[command(flatten)]
    rig: RigOption,

    /// Plant and encoders of the bench instead of the paper's, for both runs: the plant.toml of `commission` or `identify`
    #[arg(long, value_name = "plant.toml")]
    plant: Option<PathBuf>,

    /// Value instead of each scenario's, for both runs, such as controller.parameters.reduction_ratio=4; repeatable
    #[arg(long, value_name = "SECTION.KEY=VALUE")]
    set: Vec<String>,

    /// As --set, for the runs after compensation only, such as controller.name=braking-curve; repeatable
    #[arg(long, value_name = "SECTION.KEY=VALUE")]
    after: Vec<String>,

    /// A motor on a bridge with a current loop, for both runs, instead of a servo amplifier: 0.24 N m/A, 0.96 Ohm, 1 mH, 120 V,
    /// and a current sensor that is off by 2 %
    #[arg(long, conflicts_with = "rig")]
    bridge: bool,

    /// Folder for the figures, index.html and a record of each run
    #[arg(long, default_value = "out/experiment", value_name = "DIR")]
    out: PathBuf,

    /// Replace the records that the folder of --out holds
    #[arg(long)]
    force: bool,

    /// Write each record as CSV too, see `lashloop run --help`
    #[arg(long)]
    csv: bool,
}

impl Arguments {
    pub(crate) fn run(self, bench: &Bench) -> Result<Exit, CliError> {
        let rig = self.rig.take(bench, "experiment")?;
        let place = Place::of(rig.as_ref(), &self.device);
        if let Some(taken) = place.rig() {
            taken.rig.check_present()?;
        }
        RecordFolder::check_inside(&self.out, self.force)?;
        let supervisor = start_supervisor()?;
        prepare_folder(&self.out, &[INDEX])?;
        let (mut worst, mut compared, mut drive) = (Verdict::Pass, Vec::new(), String::new());
        let plant = self.plant.as_deref().map(plant_settings).transpose()?.unwrap_or_default();
        let bridge = if self.bridge { &BRIDGE[..] } else { &[] };
        let bridge = bridge.iter().map(|it| (*it).to_owned());
        let settings: Vec<_> = plant.into_iter().chain(bridge).chain(self.set.iter().cloned()).collect();
        let of_rig = rig.as_ref().map(|taken| &taken.rig);
        let scenarios = BENCH_SCENARIOS.map(|source| {
            let after = if source.0.ends_with("-after.toml") { &self.after[..] } else { &[] };
            scenarios(source, of_rig, &[&settings, after].concat(), &plants(bench))
        });
        for scenarios in scenarios.into_iter().collect::<Result<Vec<_>, _>>()? {
            let Both { name, of_bench, of_hil } = scenarios;
            let recorder = self.recorder(name, "experiment", place.rig_file())?;
            let folder = recorder.folder().to_owned();
            let (experiment, judged, description) = experiment(of_bench, place, &supervisor, recorder)?;
            write_csv(&folder, self.csv);
            let recorder = self.recorder(name, "simulation", None)?;
            let folder = recorder.folder().to_owned();
            let (simulation, simulated) = simulate(of_hil, &supervisor, recorder)?;
            write_csv(&folder, self.csv);
            outln!("{name:<40} simulation {simulated}, experiment {judged}");
            (worst, drive) = (worst.max(simulated).max(judged), description);
            compared.push(Compared { simulation, experiment });
            if supervisor.interrupted() {
                return Ok(worst.into());
            }
        }
        let [smooth_before, smooth_after, friction_before, friction_after] =
            <[Compared; 4]>::try_from(compared).expect("a comparison for each scenario");
        self.report(
            &Experiment {
                smooth: BeforeAfter { before: smooth_before, after: smooth_after },
                friction: BeforeAfter { before: friction_before, after: friction_after },
            },
            &drive,
        )?;
        Ok(worst.into())
    }

    /// Records one of the runs with the scenario of this name.
    fn recorder(&self, scenario: &str, of: &str, rig: Option<String>) -> Result<RecordWriter, CliError> {
        let stem = Path::new(scenario).file_stem().unwrap_or_default().to_string_lossy();
        let folder = RecordFolder::claim(&self.out.join(format!("{stem}-{of}")), self.force)?;
        let source = RunSource {
            command_line: command_line(),
            working_directory: working_directory(),
            rig,
            ..RunSource::default()
        };
        Ok(RecordWriter::new(folder, source))
    }

    /// Prints the table and writes the figures, the page that shows them last.
    fn report(&self, runs: &Experiment, drive: &str) -> Result<(), CliError> {
        let table = comparison_table(runs);
        outln!("\n{table}");
        let figures = comparison_figures(runs);
        for (number, figure) in &figures {
            write_file(&self.out.join(file_name(*number)), &figure.to_svg())?;
        }
        let version = env!("CARGO_PKG_VERSION");
        let plant = self.plant.as_ref().map_or(String::new(), |file| format!(" of {}", file.display()));
        let source =
            format!("Drawn by lashloop {version}; experiment on {drive}, simulation{plant} in process.");
        let index = self.out.join(INDEX);
        write_file(&index, &page(&COMPARISON, &figures, &[table], &source))?;
        outln!("\nfigures: {}", index.display());
        Ok(())
    }
}

/// Key that a plant has in HIL mode only.
const TORQUE_DELAY: &str = "plant.torque_delay_us=";

/// The plant of a file as settings of a scenario. What the file leaves out has its default.
fn plant_settings(file: &Path) -> Result<Vec<String>, CliError> {
    let input = |source| CliError::Input { path: file.to_owned(), source };
    let text = regular_file::read_text(file).map_err(input)?;
    let invalid = |problem: String| input(io::Error::other(problem));
    let document: DocumentMut =
        text.parse().map_err(|error: toml_edit::TomlError| invalid(error.message().to_owned()))?;
    let mut settings = vec!["plant={}".to_owned()];
    for (section, keys) in document.iter() {
        let keys = keys.as_table().filter(|_| ["plant", "encoders"].contains(&section));
        let keys =
            keys.ok_or_else(|| invalid(format!("it has {section}; [plant] and [encoders] are taken")))?;
        for (key, value) in keys {
            let mut value = value
                .as_value()
                .cloned()
                .ok_or_else(|| invalid(format!("{section}.{key} is a section; give its keys by --set")))?;
            value.decor_mut().clear();
            settings.push(format!("{section}.{key}={value}"));
        }
    }
    Ok(settings)
}

/// A scenario in both modes.
struct Both {
    name: &'static str,
    of_bench: Scenario,
    of_hil: Scenario,
}

/// A scenario in both modes. Its limits become those of the rig, as far as they exceed them, and its encoders those of the rig.
fn scenarios(
    (name, text): Source,
    rig: Option<&Rig>,
    settings: &[String],
    plants: &Plants,
) -> Result<Both, CliError> {
    let settings = |mode: &str| {
        // At the pins the torque has the delay of the drive itself.
        let is_of_mode = |it: &&String| mode == "hil" || !it.starts_with(TORQUE_DELAY);
        let settings = settings.iter().filter(is_of_mode).cloned().map(Override::Set);
        settings.chain([Override::Mode(mode.to_owned())]).collect::<Vec<_>>()
    };
    let mut of_bench = Scenario::from_str_with(name, text, &settings("bench"), plants)?;
    let mut of_hil = Scenario::from_str_with(name, text, &settings("hil"), plants)?;
    if let Some(rig) = rig {
        for reduced in rig.limits.reduce(&mut of_bench) {
            warn(format_args!("{name}: {reduced}"));
        }
        let _ = rig.limits.reduce(&mut of_hil);
        rig.allows(&of_bench).map_err(RigError::from)?;
        rig.equip(&mut of_bench);
        of_hil.encoders = of_bench.encoders.clone();
    }
    Ok(Both { name, of_bench, of_hil })
}

fn simulate(
    scenario: Scenario,
    supervisor: &Supervisor,
    recorder: RecordWriter,
) -> Result<(Run, Verdict), CliError> {
    let choice: DeviceChoice = "inproc".parse().expect("a kind of device");
    let mut drive = OpenDrive::open(&scenario, (&choice).into(), Clock::Lockstep, supervisor)?;
    run_for_figure(&mut drive, scenario, 0.0, supervisor, Some(recorder))
}

/// Runs a scenario in bench mode. Also returns what the drive is.
fn experiment(
    scenario: Scenario,
    place: Place<'_>,
    supervisor: &Supervisor,
    recorder: RecordWriter,
) -> Result<(Run, Verdict, String), CliError> {
    let lockstep = ClockName::Lockstep;
    let has_plant = place.choice().for_run(&scenario, lockstep)?.keeps_bench_clock(lockstep);
    let clock = if has_plant { Clock::Lockstep } else { Clock::RealTime(RealTime::default()) };
    if !has_plant {
        // An operator moves no load for a drive that isn't there. The port is free while its drive is powered off and on.
        drop(OpenDrive::open(&scenario, place, clock, supervisor)?);
        wait_for_start(&scenario)?;
    }
    let mut drive = OpenDrive::open(&scenario, place, clock, supervisor)?;
    for warning in drive.device().warnings() {
        warn(format_args!("{warning}"));
    }
    let (run, verdict) = run_for_figure(&mut drive, scenario, 0.0, supervisor, Some(recorder))?;
    Ok((run, verdict, drive.device().description()))
}

/// Waits until a person has brought the load to its start.
fn wait_for_start(scenario: &Scenario) -> Result<(), CliError> {
    let start_rad = scenario.plant.initial.load_position_rad;
    let mut stdout = io::stdout();
    let prompt = write!(
        stdout,
        "{}: bring the load to {start_rad:.4} rad, power the drive off and on, and press Enter: ",
        scenario.title
    );
    prompt.and_then(|()| stdout.flush()).map_err(system("print the prompt"))?;
    match io::stdin().lock().read_line(&mut String::new()) {
        Ok(0) => Err(CliError::Unconfirmed),
        Ok(_) => Ok(()),
        Err(source) => Err(CliError::System { what: "read the confirmation", source }),
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn the_simulation_has_the_encoders_of_the_rig_and_the_plant_of_the_file() {
        let rig = "title = \"t\"\ncontact = \"c\"\nboard = \"b\"\n[port]\ndevice = \"tcp:rack:1\"\n[limits]\n\
                   torque_nm = 25.0\nload_travel_rad = 4.0\n[encoders]\nmotor_counts_per_rev = 8192\n\
                   [power_stage]\ntorque_per_duty_nm = 62.5\n";
        let rig = Rig::from_str("rig.toml", rig).unwrap_or_else(|errors| panic!("{errors}"));
        let file = tempfile::NamedTempFile::new().expect("a file");
        let plant = "[plant]\nmodel = \"backlash-shaft\"\ndead_zone_rad = 0.2 # 0.1 to 0.3 rad\ntorque_delay_us = 75\n\
                     [encoders]\nload_counts_per_rev = 20000\n";
        fs::write(file.path(), plant).expect("a plant");
        let mut settings = plant_settings(file.path()).expect("settings");
        settings.push("meant=[\"start\", \"mismatch\", \"large-angle\"]".to_owned());
        let plants = plants(&Bench::new());
        for source in BENCH_SCENARIOS {
            let Both { of_bench, of_hil, .. } = scenarios(source, Some(&rig), &settings, &plants)
                .unwrap_or_else(|error| panic!("{}: {error}", source.0));
            for scenario in [&of_bench, &of_hil] {
                assert_eq!(scenario.plant.model.name(), "backlash-shaft", "{}", source.0);
                assert_eq!(scenario.plant.number("dead_zone_rad"), Some(0.2), "{}", source.0);
                let encoders = &scenario.encoders;
                assert_eq!((encoders.motor_counts_per_rev, encoders.load_counts_per_rev), (8192, 20_000));
            }
            assert_eq!(of_hil.plant.torque_delay_us(), 75);
        }
    }

    #[test]
    fn a_file_that_is_no_plant_names_what_it_has() {
        let file = tempfile::NamedTempFile::new().expect("a file");
        fs::write(file.path(), "[controller]\nname = \"pd\"\n").expect("a file");
        let error = plant_settings(file.path()).expect_err("no plant").to_string();
        assert!(error.contains("it has controller; [plant] and [encoders] are taken"), "{error}");
    }
}
