//! `lashloop bode`: the frequency response of a loop and of its drive train.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use lashloop::Bench;
use lashloop::bode::{Measurement, measure};
use lashloop::execution::Place;
use lashloop_bench::device::DeviceChoice;
use lashloop_bench::scenario::{Override, RunMode, Scenario};
use lashloop_bench::verdict::Exit;
use lashloop_report::page;
use lashloop_report::response_figure::{Shown, figure};
use lashloop_response::{Excitation, Plan, table};

use super::bode_table::{of_one, of_series};
use super::clock_options::ClockOptions;
use super::error::CliError;
use super::options::{RigOption, plants, positive};
use super::output::{error_line, outln, program_name, write_file};
use super::supervision::start_supervisor;

/// Measure the frequency response of a loop and of its drive train
///
/// In HIL mode a torque on top of that of the drive excites the loop around the scenario's start; the response shows sensitivity,
/// open loop and plant. In bench mode the reference is excited; the response shows plant and closed loop, and the law open-loop makes
/// a torque of the reference. Each line has a coherence and an interval from realisations with other phases. Two masses on a shaft,
/// fitted to the plant, give resonance, antiresonance, stiffness and inertia ratio.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Scenario whose plant, encoders, law and start are taken
    scenario: PathBuf,

    /// Value instead of the scenario's, such as plant.dead_zone_rad=0.01; repeatable
    #[arg(long, value_name = "SECTION.KEY=VALUE")]
    set: Vec<String>,

    /// Drive, see `lashloop run --help`
    #[arg(long, default_value = "inproc", value_name = "DEVICE", conflicts_with = "rig")]
    device: DeviceChoice,

    #[command(flatten)]
    rig: RigOption,

    /// Mode instead of the scenario's, see `lashloop run --help` [default with --rig: bench]
    #[arg(long, value_name = "MODE", value_parser = ["hil", "bench"])]
    mode: Option<String>,

    /// Largest excitation: N m in HIL mode, rad of the reference in bench mode; several, separated by commas, make a series
    /// [default: 0.5 in HIL mode]
    #[arg(long, value_name = "AMPLITUDE", value_delimiter = ',', value_parser = positive)]
    amplitudes: Vec<f64>,

    /// HIL mode: speed of the load during the measurement, in rad/s; in motion dry friction is a constant and closes the gap
    #[arg(long, value_name = "RAD_S", default_value_t = 0.0, allow_negative_numbers = true)]
    speed: f64,

    /// All tones at once with random phases, or one after the other
    #[arg(long, value_enum, default_value_t = Choice::Multisine, value_name = "EXCITATION")]
    excitation: Choice,

    /// Frequency of the lowest tone, in Hz
    #[arg(long, value_name = "HZ", default_value_t = 0.1, value_parser = positive)]
    lowest_hz: f64,

    /// Frequency that no tone exceeds, in Hz [default: a fifth of the sampling frequency]
    #[arg(long, value_name = "HZ", value_parser = positive)]
    highest_hz: Option<f64>,

    /// Tones at most, at about equal ratios
    #[arg(long, value_name = "COUNT", default_value_t = 60, value_parser = clap::value_parser!(u32).range(1..=1000))]
    lines: u32,

    /// Sets of phases, whose scatter gives coherence and intervals
    #[arg(long, value_name = "COUNT", default_value_t = 8, value_parser = clap::value_parser!(u32).range(3..=1000))]
    realisations: u32,

    /// Windows that count in each realisation; a window of the multisine is 1 / lowest frequency
    #[arg(long, value_name = "COUNT", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1000))]
    windows: u32,

    /// Time for which the loop settles under each set of phases, in s; twice that at the start
    #[arg(long, value_name = "S", default_value_t = 20.0, value_parser = positive)]
    settles_s: f64,

    /// Seed of the phases
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    seed: u64,

    #[command(flatten)]
    clock: ClockOptions,

    /// Write the lines of all responses and amplitudes to this file
    #[arg(long, value_name = "FILE.csv")]
    csv: Option<PathBuf>,

    /// Write magnitude, phase, sensitivity and coherence as a figure to this file
    #[arg(long, value_name = "FILE.svg")]
    svg: Option<PathBuf>,

    /// Write result and figure as a page for a browser to this file
    #[arg(long, value_name = "FILE.html")]
    report: Option<PathBuf>,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Choice {
    Multisine,
    Sine,
}

/// Largest excitation of a simulated plant by default, in N m.
const AMPLITUDE_NM: f64 = 0.5;
/// Highest tone by default, as a share of the sampling frequency.
const HIGHEST: f64 = 0.2;

impl Arguments {
    pub(crate) fn run(self, bench: &Bench) -> Result<Exit, CliError> {
        let rig = self.rig.take(bench, "bode")?;
        let mode = self.mode.clone().or_else(|| rig.as_ref().map(|_| "bench".to_owned()));
        let set = self.set.iter().cloned().map(Override::Set);
        let overrides: Vec<_> = mode.map(Override::Mode).into_iter().chain(set).collect();
        let scenario = Scenario::from_file_with(&self.scenario, &overrides, &plants(bench))?;
        let place = Place::of(rig.as_ref(), &self.device);
        let clock = self.clock.for_drive(&scenario, place.choice())?;
        let supervisor = start_supervisor()?;
        let _signals = supervisor.guard_signals();
        let mut measurements: Vec<Measurement> = Vec::new();
        let mut text = Vec::new();
        let mut print = |lines: Vec<String>| {
            lines.iter().for_each(|line| outln!("{line}"));
            text.extend(lines);
        };
        for amplitude in self.amplitudes(&scenario)? {
            let plan = self.plan(&scenario, amplitude);
            let Some(measurement) = measure(&scenario, place, clock, &supervisor, &plan, self.speed)? else {
                error_line(format_args!(
                    "INVALID: interrupted by the user before the measurement was complete"
                ));
                return Ok(Exit::Invalid);
            };
            print(of_one(&measurement));
            measurements.push(measurement);
        }
        if measurements.len() > 1 {
            print(of_series(&scenario, self.excitation(), &measurements));
        }
        self.write(&scenario, &measurements, &text.join("\n"))?;
        Ok(Exit::Pass)
    }

    /// Writes the files that are asked for.
    fn write(&self, scenario: &Scenario, measurements: &[Measurement], text: &str) -> Result<(), CliError> {
        let Some(first) = measurements.first() else { return Ok(()) };
        if let Some(path) = &self.csv {
            let rows = measurements.iter().map(|it| (it.amplitude, &it.measured));
            write_file(path, &table::csv(first.excited, rows))?;
        }
        if self.svg.is_none() && self.report.is_none() {
            return Ok(());
        }
        let shown = measurements.iter();
        let shown =
            shown.map(|it| Shown { amplitude: it.amplitude, excited: it.excited, measured: &it.measured });
        let shown: Vec<Shown<'_>> = shown.collect();
        let title = format!("Frequency response: {}", scenario.title);
        let caption = "Shades are intervals of 95 %, from the scatter over the realisations.";
        let svg = figure(&title, caption, &shown).to_svg();
        if let Some(path) = &self.svg {
            write_file(path, &svg)?;
        }
        if let Some(path) = &self.report {
            let words = std::iter::once(program_name()).chain(std::env::args().skip(1));
            write_file(path, &page::response(&title, text, &svg, &words.collect::<Vec<_>>()))?;
        }
        Ok(())
    }

    /// The amplitudes. Those that move a machine have no default.
    fn amplitudes(&self, scenario: &Scenario) -> Result<Vec<f64>, CliError> {
        match (&self.amplitudes[..], scenario.run.mode) {
            ([], RunMode::Hil) => Ok(vec![AMPLITUDE_NM]),
            ([], RunMode::Bench) => Err(CliError::CommissionLimit {
                option: "--amplitudes",
                problem: "is missing; in bench mode it moves a machine: state the largest excitation of the reference, in rad".to_owned(),
            }),
            (given, _) => Ok(given.to_vec()),
        }
    }

    fn excitation(&self) -> Excitation {
        match self.excitation {
            Choice::Multisine => Excitation::Multisine,
            Choice::Sine => Excitation::Sine,
        }
    }

    fn plan(&self, scenario: &Scenario, amplitude: f64) -> Plan {
        Plan {
            control_period_us: scenario.run.control_period_us,
            excitation: self.excitation(),
            amplitude,
            lowest_hz: self.lowest_hz,
            highest_hz: self.highest_hz.unwrap_or(HIGHEST / scenario.run.control_period_s()),
            lines: self.lines,
            realisations: self.realisations,
            windows: self.windows,
            settles_s: self.settles_s,
            seed: self.seed,
        }
    }
}
