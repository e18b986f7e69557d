//! `lashloop commission`: motions that show an unknown drive train, and the estimates from them.

use std::cell::RefCell;
use std::io::{self, IsTerminal as _, Write as _};
use std::path::{Path, PathBuf};

use clap::Args;
use lashloop_bench::device::DeviceChoice;
use lashloop_bench::scenario::{Override, Scenario, ScenarioErrors};
use lashloop_bench::verdict::Exit;
use lashloop_identify::Instruments;
use lashloop_identify::excitation::{Commissioned, CommissioningError, Halt, Limits, commission};
use lashloop_record::folder::RecordFolder;
use lashloop_record::source::RunSource;
use lashloop_record::summary::Summary;
use lashloop_record::writer::RecordWriter;

use super::clock_options::ClockOptions;
use super::commission_motor;
use super::encoder_errors::EncoderErrors;
use super::error::{CliError, system};
use super::first_reach;
use super::identify::{encoder_noise, write_estimates};
use super::options::{RigOption, plants, positive};
use super::output::{error_line, outln, prepare_folder, write_csv, write_file};
use super::supervision::start_supervisor;
use lashloop::Bench;
use lashloop::execution::{OpenDrive, Place};
use lashloop::rig::limits::Excess;
use lashloop::rig::{Rig, TakenRig};
use lashloop_hardware::commission::{
    MotionError, OnDevice, RecordError, RunRecord, set_pin, settings, stated,
};
use lashloop_hardware::identify::files::{DriveUse, GivenOfMotion, INSTRUMENTS_FILE, motor_toml, table};
use lashloop_hardware::identify::power_stage::{TORQUE_DELAY_US, instruments};
use lashloop_hardware::identify::reach::{self, FirstReach};

/// The scenario of a command line without one.
const SCENARIO: &str = include_str!("../data/commission.toml");
const SCENARIO_NAME: &str = "scenarios/commission.toml";

/// Move an unknown drive train within limits and estimate its parameters
///
/// The motions are torques without a loop: a slow ramp each way until the load moves, a slow reversal, steps, and pulses. No
/// motion begins before the limits are confirmed, and a limit that is exceeded switches the torque off. At the end the law
/// braking-curve makes a reach on the estimated plant, in a simulation.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Scenario whose mode, period, encoders and plant are taken [default: scenarios/commission.toml]
    scenario: Option<PathBuf>,

    /// Value instead of the scenario's, such as encoders.motor_counts_per_rev=8192; repeatable
    #[arg(long, value_name = "SECTION.KEY=VALUE")]
    set: Vec<String>,

    /// Drive, see `lashloop run --help`
    #[arg(long, default_value = "native", value_name = "DEVICE", conflicts_with = "rig")]
    device: DeviceChoice,

    #[command(flatten)]
    rig: RigOption,

    /// Mode instead of the scenario's, see `lashloop run --help` [default with --rig: bench]
    #[arg(long, value_name = "MODE", value_parser = ["hil", "bench"])]
    mode: Option<String>,

    /// Largest torque at the motor, in N m [default: that of the rig]
    #[arg(long, value_name = "N_M", value_parser = positive, allow_negative_numbers = true)]
    torque_limit: Option<f64>,

    /// Largest speed of the motor, in rad/s [default: that of the rig]
    #[arg(long, value_name = "RAD_S", value_parser = positive, allow_negative_numbers = true)]
    motor_speed_limit: Option<f64>,

    /// Largest speed of the load, in rad/s [default: that of the rig]
    #[arg(long, value_name = "RAD_S", value_parser = positive, allow_negative_numbers = true)]
    load_speed_limit: Option<f64>,

    /// Largest distance of the load from its first position, in rad [default: that of the rig]
    #[arg(long, value_name = "RAD", value_parser = positive, allow_negative_numbers = true)]
    travel_limit: Option<f64>,

    /// End after the electrical side of a motor at a bridge
    #[arg(long)]
    only_electrical: bool,

    /// Confirm the limits without a question
    #[arg(long)]
    yes: bool,

    /// Bench mode: time from a tick to the torque at the motor, in us; its standard deviation is a third of it [default: 75]
    #[arg(long, value_name = "US", value_parser = clap::value_parser!(u32).range(0..=100_000))]
    torque_delay_us: Option<u32>,

    /// Noise of both encoders in counts: edges jitter uniformly by up to this in either direction [default: none; in HIL
    /// mode that of the scenario]
    #[arg(long, value_name = "COUNTS", value_parser = encoder_noise)]
    encoder_noise: Option<f64>,

    #[command(flatten)]
    encoder_errors: EncoderErrors,

    /// Scenario whose plant the estimation starts from, within a factor of 50 of the truth [default: the paper's bench]
    #[arg(long, value_name = "SCENARIO")]
    start: Option<PathBuf>,

    #[command(flatten)]
    clock: ClockOptions,

    /// Folder for plant.toml, drive.toml, estimates.json, reach.toml and a record of each motion
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,

    /// Replace the records that the folder of --out holds
    #[arg(long, requires = "out")]
    force: bool,

    /// Write each record as CSV too, see `lashloop run --help`
    #[arg(long, requires = "out")]
    csv: bool,
}

impl Arguments {
    pub(crate) fn run(self, bench: &Bench) -> Result<Exit, CliError> {
        let rig = self.rig.take(bench, "commission")?;
        let mut limits = self.limits(rig.as_ref())?;
        // What the motor has been found to be, for the motions after.
        let found = RefCell::new(Vec::<(&'static str, f64)>::new());
        let confirmed_limits = limits;
        let scenario = |more: &[String]| {
            let of_rig = rig.as_ref().map(|taken| &taken.rig);
            let mut scenario = self.scenario(of_rig, &settings(&confirmed_limits), more, bench)?;
            for (name, value) in &*found.borrow() {
                set_pin(&mut scenario, name, *value);
            }
            Ok(scenario)
        };
        let template = scenario(&[])?;
        let stated = stated(&template, &limits);
        if self.only_electrical && stated.is_none() {
            return Err(CliError::CommissionLimit {
                option: "--only-electrical",
                problem: "needs bench mode and a drive that makes the torque by a current sensor: set its parameter torque_source \
                          to \"current\""
                    .to_owned(),
            });
        }
        let place = Place::of(rig.as_ref(), &self.device);
        place.check(&template)?;
        let start = self.start.as_deref().map(|file| super::identify::start(file, bench)).transpose()?;
        if let Some(folder) = &self.out {
            RecordFolder::check_inside(folder, self.force)?;
        }
        let supervisor = start_supervisor()?;
        let clock = self.clock.for_drive(&template, place.choice())?;
        let drive = OpenDrive::open(&template, place, clock, &supervisor)?;
        let drive = drive.with_excess(Excess::Guarded);
        if !confirmed(&limits, &place.choice().to_string(), self.yes)? {
            outln!("not confirmed: nothing was moved");
            return Ok(Exit::Invalid);
        }
        let known = self.instruments(&template, rig.as_ref());
        if let Some(folder) = &self.out {
            prepare_folder(folder, &[reach::REACH_FILE])?;
        }
        let temporary = tempfile::tempdir().map_err(system("create a temporary folder"))?;
        let mut source = RunSource::new(
            Path::new(&template.name),
            &self.overrides(rig.as_ref().map(|taken| &taken.rig), &settings(&limits), &[]),
            &plants(bench),
        );
        source.rig = place.rig_file();
        let writer = |name: &str| {
            let Some(folder) = &self.out else { return Ok(None) };
            let claimed = RecordFolder::claim(&folder.join(name), self.force);
            let claimed = claimed.map_err(|error| RecordError(Box::new(error)))?;
            Ok(Some(RecordWriter::new(claimed, source.clone())))
        };
        let mut record = |mut run: RunRecord<'_>| {
            let end = match run.halt {
                Some(Halt::Moved) => "until the load moved".to_owned(),
                Some(Halt::Exceeded(exceeded)) => format!("halted: {exceeded}"),
                Some(Halt::NotAtRest | Halt::Noisy(_)) | None => run.outcome.end.to_string(),
            };
            outln!("{:<20} {} steps, {end}", run.name, run.outcome.steps);
            let Some(writer) = run.writer.take() else { return Ok(()) };
            let folder = writer.folder().to_owned();
            complete(writer, &run, &known)?;
            write_csv(&folder, self.csv);
            Ok(())
        };
        let mut drive_train = OnDevice {
            scenario: &scenario,
            drive,
            mode: template.run.mode,
            instruments: known,
            period_s: template.run.control_period_s(),
            folder: temporary.path(),
            writer: &writer,
            record: &mut record,
        };
        let period_us = template.run.control_period_us;
        let signals = supervisor.guard_signals();
        let mut motor_lines = String::new();
        if let Some(stated) = stated {
            let motor =
                commission_motor::find(&mut drive_train, &known, &limits, stated, self.out.as_deref())?;
            limits.load_travel_rad -= motor.load_moved_rad;
            motor_lines = motor_toml(&motor);
            if self.only_electrical {
                return Ok(Exit::Pass);
            }
            commission_motor::check_torque(&motor, &template, &limits)?;
            let quantities = motor.quantities().into_iter();
            let values = quantities.filter_map(|it| Some((it.drive_parameter?, it.estimate?.value)));
            *found.borrow_mut() = values.collect();
        }
        let commissioned =
            commission(&mut drive_train, &known, &limits, period_us, &start.unwrap_or_default());
        drop(signals);
        let Commissioned { identified, breakaway, held_nm, .. } = commissioned.map_err(failed)?;
        let (forward_nm, backward_nm) = (breakaway.forward_nm, breakaway.backward_nm);
        if held_nm != 0.0 {
            outln!("held torque          {held_nm:.4} N m: the drive train rests under it");
        }
        outln!(
            "breakaway            {forward_nm:.4} N m forward, {backward_nm:.4} N m backward, at the motor\n"
        );
        outln!("{}", table(&identified).trim_end());
        let offers = |name: &str| drive_train.drive.device().session.parameter(name).is_some();
        let of_drive = DriveUse { mode: template.run.mode, torque_limit_nm: limits.torque_nm };
        if let Some(folder) = &self.out {
            write_estimates(folder, &identified, of_drive, &motor_lines, offers)?;
        }
        if !identified.is_followed() {
            return Ok(Exit::Invalid);
        }
        let device = drive_train.drive.device();
        if !device.session.laws.iter().any(|it| it.name == reach::LAW) {
            outln!("\nthe drive lacks the law {}: no first reach", reach::LAW);
            return Ok(Exit::Pass);
        }
        let of_rig = rig.as_ref().map(|it| &it.rig);
        let make = |settings: Vec<String>| -> Result<Scenario, CliError> {
            let mut made = self.scenario(of_rig, &[], &settings, bench)?;
            for (name, value) in &*found.borrow() {
                set_pin(&mut made, name, *value);
            }
            Ok(made)
        };
        let reach = FirstReach { identified: &identified, of: of_drive, limits: &limits, offers: &offers };
        let (simulated, of_drive) = (make(reach.simulated())?, make(reach.of_drive(&template))?);
        first_reach::of(&reach, &simulated, &of_drive, self.out.as_deref(), &supervisor, bench)
    }

    /// The limits of the options; those of the rig where an option is absent.
    fn limits(&self, rig: Option<&TakenRig>) -> Result<Limits, CliError> {
        let of_rig = rig.map(|taken| &taken.rig.limits);
        let absent = |key: &str| match rig {
            Some(taken) => format!("is missing, and {} has no limits.{key}", taken.rig.file.display()),
            None => "is missing, and there is no --rig to have it".to_owned(),
        };
        let limit = |option: &'static str, key, given: Option<f64>, of_rig: Option<f64>| match (given, of_rig)
        {
            (Some(given), Some(largest)) if given > largest => Err(CliError::CommissionLimit {
                option,
                problem: format!("{given} exceeds the rig's {largest}"),
            }),
            (given, of_rig) => {
                given.or(of_rig).ok_or_else(|| CliError::CommissionLimit { option, problem: absent(key) })
            }
        };
        Ok(Limits {
            torque_nm: limit(
                "--torque-limit",
                "torque_nm",
                self.torque_limit,
                of_rig.map(|it| it.torque_nm),
            )?,
            motor_speed_rad_s: limit(
                "--motor-speed-limit",
                "motor_speed_rad_s",
                self.motor_speed_limit,
                of_rig.and_then(|it| it.motor_speed_rad_s),
            )?,
            load_speed_rad_s: limit(
                "--load-speed-limit",
                "load_speed_rad_s",
                self.load_speed_limit,
                of_rig.and_then(|it| it.load_speed_rad_s),
            )?,
            load_travel_rad: limit(
                "--travel-limit",
                "load_travel_rad",
                self.travel_limit,
                of_rig.map(|it| it.load_travel_rad),
            )?,
        })
    }

    fn overrides(&self, rig: Option<&Rig>, first: &[String], more: &[String]) -> Vec<Override> {
        let mode = self.mode.clone().or_else(|| rig.map(|_| "bench".to_owned()));
        let of_rig = rig.map(encoders_of).unwrap_or_default();
        let settings = self.set.iter().cloned().chain(of_rig).chain(first.iter().chain(more).cloned());
        mode.map(Override::Mode).into_iter().chain(settings.map(Override::Set)).collect()
    }

    /// What is given of the instruments. In bench mode the power stage has a delay and a step.
    fn instruments(&self, template: &Scenario, rig: Option<&TakenRig>) -> Instruments {
        let of_rig = rig.and_then(|taken| taken.rig.power_stage.torque_per_duty_nm);
        let torque_per_duty_nm = of_rig.or(template.bench.torque_per_duty_nm());
        let delay_us = self.torque_delay_us.unwrap_or(TORQUE_DELAY_US);
        let of_template = instruments(template, torque_per_duty_nm, delay_us);
        let of_rig = rig.map_or([None; 2], |taken| {
            let encoders = &taken.rig.encoders;
            [encoders.motor_error_rad, encoders.load_error_rad]
        });
        Instruments {
            noise_counts: self.encoder_noise.unwrap_or(of_template.noise_counts),
            encoder_error_rad: self.encoder_errors.or(of_rig, of_template.encoder_error_rad),
            ..of_template
        }
    }

    /// The scenario under what the command line and the rig have, and then these settings.
    fn scenario(
        &self,
        rig: Option<&Rig>,
        first: &[String],
        more: &[String],
        bench: &Bench,
    ) -> Result<Scenario, ScenarioErrors> {
        let overrides = self.overrides(rig, first, more);
        match &self.scenario {
            Some(file) => Scenario::from_file_with(file, &overrides, &plants(bench)),
            None => Scenario::from_str_with(SCENARIO_NAME, SCENARIO, &overrides, &plants(bench)),
        }
    }
}

/// Shows the limits and takes the confirmation.
fn confirmed(limits: &Limits, device: &str, yes: bool) -> Result<bool, CliError> {
    let Limits { torque_nm, motor_speed_rad_s, load_speed_rad_s, load_travel_rad } = limits;
    error_line(format_args!(
        "{device} is about to move: torque up to {torque_nm} N m, motor up to {motor_speed_rad_s} rad/s, load up to \
         {load_speed_rad_s} rad/s, within {load_travel_rad} rad in either direction of where the load stands"
    ));
    if yes {
        return Ok(true);
    }
    if !io::stdin().is_terminal() {
        return Err(CliError::CommissionLimit {
            option: "--yes",
            problem: "is missing, and standard input isn't a terminal to confirm the limits on".to_owned(),
        });
    }
    let mut stderr = io::stderr();
    let asked = write!(stderr, "Keep clear. Type yes to start: ").and_then(|()| stderr.flush());
    asked.map_err(system("write to the terminal"))?;
    let mut answer = String::new();
    io::stdin().read_line(&mut answer).map_err(system("read from the terminal"))?;
    Ok(answer.trim() == "yes")
}

/// The resolutions that a rig file has, as settings of a scenario.
fn encoders_of(rig: &Rig) -> Vec<String> {
    let [motor, load] = [rig.encoders.motor_counts_per_rev, rig.encoders.load_counts_per_rev];
    let setting = |key, counts: Option<u32>| counts.map(|counts| format!("encoders.{key}={counts}"));
    [setting("motor_counts_per_rev", motor), setting("load_counts_per_rev", load)]
        .into_iter()
        .flatten()
        .collect()
}

/// Completes the record of a motion, with the facts that `identify` needs.
fn complete(writer: RecordWriter, run: &RunRecord<'_>, known: &Instruments) -> Result<(), RecordError> {
    let given = GivenOfMotion { instruments: *known, held: run.held };
    let known = serde_json::to_string_pretty(&given).map_err(|error| RecordError(Box::new(error)))?;
    write_file(&writer.folder().join(INSTRUMENTS_FILE), &(known + "\n"))
        .map_err(|error| RecordError(error.to_string().into()))?;
    let summary = Summary::new(run.scenario, run.device, run.outcome);
    writer.finish(&summary).map_err(|error| RecordError(Box::new(error)))
}

fn failed(error: CommissioningError<MotionError>) -> CliError {
    match error {
        CommissioningError::Motion(MotionError::Run(error)) => error.into(),
        CommissioningError::Motion(MotionError::Scenario(errors)) => CliError::Scenario(errors),
        CommissioningError::Identify(error) => CliError::Identify(error),
        other => CliError::Commission(Box::new(other)),
    }
}
