//! `lashloop identify`: estimates of a drive train from records.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use lashloop_bench::regular_file;
use lashloop_bench::scenario::{Override, RunMode, Scenario};
use lashloop_bench::verdict::Exit;
use lashloop_identify::{Identified, Instruments, Start};
use lashloop_plant::Mechanics;
use lashloop_plant::backlash_shaft::{ShaftParameters, StribeckParameters};
use lashloop_plant::encoder::{MAX_COUNTS_PER_REV, MAX_NOISE_COUNTS, MIN_COUNTS_PER_REV};
use lashloop_protocol::parameter_names::TORQUE_LIMIT_NM;
use lashloop_record::file_names::SCENARIO_FILE;
use lashloop_record::json_file::write_json;
use lashloop_record::manifest::Manifest;
use lashloop_record::reader::Record;

use super::encoder_errors::EncoderErrors;
use super::error::CliError;
use super::options::plants;
use super::output::{outln, prepare_folder, print_json, write_file};
use lashloop::Bench;
use lashloop_hardware::identify::files::{
    DRIVE_FILE, DriveUse, ESTIMATES_FILE, GivenOfMotion, INSTRUMENTS_FILE, PLANT_FILE, drive_toml,
    plant_toml, table,
};
use lashloop_hardware::identify::models::Simulator;
use lashloop_hardware::identify::power_stage::{TORQUE_DELAY_US, instruments};
use lashloop_hardware::identify::record::{directions_in_force, series};

/// Estimate a drive train from records, with 95 % intervals
///
/// A record is a folder of `run --out` or of `commission --out`, of a closed or an open loop, that begins at rest. Only the
/// period, the torques and the counts are used. What the records don't excite is reported as not observable.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Folders of records; several are one drive train in several motions
    #[arg(required = true, value_name = "RECORD")]
    records: Vec<PathBuf>,

    /// Counts of the motor encoder per revolution [default: those of the record's scenario]
    #[arg(long, value_name = "COUNTS", value_parser = clap::value_parser!(u32).range(i64::from(MIN_COUNTS_PER_REV)..=i64::from(MAX_COUNTS_PER_REV)))]
    motor_counts_per_rev: Option<u32>,

    /// Counts of the load encoder per revolution [default: those of the record's scenario]
    #[arg(long, value_name = "COUNTS", value_parser = clap::value_parser!(u32).range(i64::from(MIN_COUNTS_PER_REV)..=i64::from(MAX_COUNTS_PER_REV)))]
    load_counts_per_rev: Option<u32>,

    /// Time from a sample to the arrival of its torque at the motor, in us [default: that of the record's scenario]
    #[arg(long, value_name = "US", value_parser = clap::value_parser!(u32).range(0..=1_000_000))]
    torque_delay_us: Option<u32>,

    /// Noise of both encoders in counts: edges jitter uniformly by up to this in either direction [default: that of
    /// the commissioning, else none]
    #[arg(long, value_name = "COUNTS", value_parser = encoder_noise)]
    encoder_noise: Option<f64>,

    #[command(flatten)]
    encoder_errors: EncoderErrors,

    /// Scenario whose plant the estimation starts from, within a factor of 50 of the truth [default: the
    /// record's scenario, or the paper's bench]
    #[arg(long, value_name = "SCENARIO")]
    start: Option<PathBuf>,

    /// Folder for plant.toml, drive.toml and estimates.json
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,

    /// Print the estimates as a model of another simulator instead; with --out, write it too, as drive.xml, Drive.mo or
    /// build_drive.m
    #[arg(long, value_name = "SIMULATOR", conflicts_with = "json")]
    to: Option<To>,

    /// Print the estimates as JSON, as in estimates.json
    #[arg(long, conflicts_with = "out")]
    json: bool,
}

#[derive(Clone, Copy, ValueEnum)]
enum To {
    /// MJCF of MuJoCo
    Mujoco,
    /// Modelica, without a library
    Modelica,
    /// A script of MATLAB that builds a diagram of Simulink
    SimulinkScript,
}

impl From<To> for Simulator {
    fn from(to: To) -> Self {
        match to {
            To::Mujoco => Self::Mujoco,
            To::Modelica => Self::Modelica,
            To::SimulinkScript => Self::SimulinkScript,
        }
    }
}

impl Arguments {
    pub(crate) fn run(self, bench: &Bench) -> Result<Exit, CliError> {
        let records = self
            .records
            .iter()
            .map(|folder| Ok((folder, Record::read(folder)?)))
            .collect::<Result<Vec<_>, CliError>>()?;
        let of_record = scenario(records[0].0, bench);
        let instruments = self.instruments(given(records[0].0).map(|it| it.instruments), &of_record)?;
        let Instruments { motor_counts_per_rev, load_counts_per_rev, torque_delay_us, .. } = instruments;
        let simulator = self.to.map(Simulator::from);
        let is_table = !self.json && (simulator.is_none() || self.out.is_some());
        if is_table {
            outln!(
                "given: {motor_counts_per_rev} counts per revolution of the motor, {load_counts_per_rev} of the load; torque delay \
             {torque_delay_us} us\n"
            );
        }
        let mut motions = Vec::new();
        let mut of_drive = DriveUse { mode: RunMode::Bench, torque_limit_nm: 0.0 };
        for (folder, record) in &records {
            let unfit = |source| CliError::Motion { folder: folder.to_path_buf(), source };
            let Manifest { mode: of_record, parameters, .. } = &record.manifest;
            let choice = |name: &str| parameters.iter().find(|it| it.name == name)?.choice.clone();
            let in_force = directions_in_force(*of_record, choice);
            let motion = series(&record.trace, &instruments, *of_record, in_force).map_err(unfit)?;
            // A record that was held begins under the torque that it rests under.
            let held = given(folder).and_then(|it| it.held);
            let motion = held.map_or(Ok(motion.clone()), |held| motion.held(held));
            motions.push(motion.map_err(|source| unfit(source.into()))?);
            if of_record.is_hil() {
                of_drive.mode = *of_record;
            }
            let limit_nm = parameters
                .iter()
                .find(|it| it.name == TORQUE_LIMIT_NM)
                .map(|it| it.value.to_string().parse().unwrap_or(f64::NAN));
            of_drive.torque_limit_nm = of_drive.torque_limit_nm.max(limit_nm.unwrap_or_default());
        }
        let start = match (&self.start, &of_record) {
            (Some(file), _) => start(file, bench)?,
            (None, Ok(scenario)) => start_of(scenario),
            (None, Err(_)) => Start::default(),
        };
        let identified = lashloop_identify::identify(&motions, &instruments, &start)?;
        if self.json {
            print_json(&identified)?;
        } else if is_table {
            outln!("{}", table(&identified).trim_end());
        }
        match (&self.out, simulator) {
            (Some(folder), _) => {
                prepare_folder(folder, &[])?;
                write_estimates(folder, &identified, of_drive, "", |_| true)?;
                if let Some(simulator) = simulator {
                    let file = folder.join(simulator.file_name());
                    write_file(&file, &simulator.model(&identified))?;
                    outln!("{}", file.display());
                }
            }
            (None, Some(simulator)) => outln!("{}", simulator.model(&identified).trim_end()),
            (None, None) => {}
        }
        Ok(Exit::Pass)
    }

    /// What the options give, the rest from the file of a commissioning, else from the scenario of the record.
    fn instruments(
        &self,
        of_commissioning: Option<Instruments>,
        of_record: &Result<Scenario, String>,
    ) -> Result<Instruments, CliError> {
        let given = (self.motor_counts_per_rev, self.load_counts_per_rev, self.torque_delay_us);
        if let (Some(motor_counts_per_rev), Some(load_counts_per_rev), Some(torque_delay_us)) = given {
            let exact = Instruments::exact(motor_counts_per_rev, load_counts_per_rev, torque_delay_us);
            let unstated = Instruments::UNSTATED_ENCODER_ERROR_RAD;
            return Ok(Instruments {
                noise_counts: self.encoder_noise.unwrap_or_default(),
                encoder_error_rad: self.encoder_errors.or([None; 2], unstated),
                ..exact
            });
        }
        let known = match (of_commissioning, of_record) {
            (Some(known), _) => known,
            (None, Ok(scenario)) => {
                instruments(scenario, scenario.bench.torque_per_duty_nm(), TORQUE_DELAY_US)
            }
            (None, Err(reason)) => return Err(CliError::Instruments { reason: reason.clone() }),
        };
        Ok(Instruments {
            motor_counts_per_rev: self.motor_counts_per_rev.unwrap_or(known.motor_counts_per_rev),
            load_counts_per_rev: self.load_counts_per_rev.unwrap_or(known.load_counts_per_rev),
            torque_delay_us: self.torque_delay_us.unwrap_or(known.torque_delay_us),
            noise_counts: self.encoder_noise.unwrap_or(known.noise_counts),
            encoder_error_rad: self.encoder_errors.or([None; 2], known.encoder_error_rad),
            ..known
        })
    }
}

/// Takes the noise of an encoder.
pub(super) fn encoder_noise(text: &str) -> Result<f64, String> {
    let counts: f64 = text.parse().map_err(|_| format!("{text:?} isn't a number"))?;
    let range = 0.0..=MAX_NOISE_COUNTS;
    range
        .contains(&counts)
        .then_some(counts)
        .ok_or_else(|| format!("{counts} is outside 0 to {MAX_NOISE_COUNTS}"))
}

/// What the commissioning that made a record has written into it.
fn given(folder: &Path) -> Option<GivenOfMotion> {
    serde_json::from_slice(&regular_file::read(&folder.join(INSTRUMENTS_FILE)).ok()?).ok()
}

/// The scenario of a record as it was resolved, or why there is none.
fn scenario(folder: &Path, bench: &Bench) -> Result<Scenario, String> {
    let resolved = folder.join(SCENARIO_FILE);
    Scenario::from_file_with(&resolved, &[], &plants(bench)).map_err(|error| error.to_string())
}

/// Writes `plant.toml`, `drive.toml` with the lines of a motor, and `estimates.json`. `offers` is whether the drive has a parameter.
pub(super) fn write_estimates(
    folder: &Path,
    identified: &Identified,
    of_drive: DriveUse,
    motor: &str,
    offers: impl Fn(&str) -> bool,
) -> Result<(), CliError> {
    write_file(&folder.join(PLANT_FILE), &plant_toml(identified))?;
    write_file(&folder.join(DRIVE_FILE), &(drive_toml(identified, of_drive, offers) + motor))?;
    write_json(&folder.join(ESTIMATES_FILE), ".estimates-", identified)?;
    for name in [PLANT_FILE, DRIVE_FILE, ESTIMATES_FILE] {
        outln!("{}", folder.join(name).display());
    }
    Ok(())
}

/// The start of the estimation: the numbers that the plant of a scenario has, the rest from the paper's bench.
pub(super) fn start(file: &Path, bench: &Bench) -> Result<Start, CliError> {
    let meant = Override::Set(r#"meant=["start", "mismatch", "large-angle"]"#.to_owned());
    Ok(start_of(&Scenario::from_file_with(file, &[meant], &plants(bench))?))
}

fn start_of(scenario: &Scenario) -> Start {
    let plant = &scenario.plant;
    let Start { mechanics, shaft } = Start::default();
    let number = |key: &str, default: f64| plant.number(key).filter(|value| *value > 0.0).unwrap_or(default);
    let stribeck =
        |[coulomb, stiction, velocity]: [&'static str; 3], default: StribeckParameters| StribeckParameters {
            coulomb_nm: number(coulomb, default.coulomb_nm),
            stiction_nm: number(stiction, default.stiction_nm),
            velocity_rad_s: number(velocity, default.velocity_rad_s),
        };
    Start {
        mechanics: Mechanics {
            motor_inertia_kg_m2: number("motor_inertia_kg_m2", mechanics.motor_inertia_kg_m2),
            motor_friction_nm_s_rad: number("motor_friction_nm_s_rad", mechanics.motor_friction_nm_s_rad),
            load_inertia_kg_m2: number("load_inertia_kg_m2", mechanics.load_inertia_kg_m2),
            load_friction_nm_s_rad: number("load_friction_nm_s_rad", mechanics.load_friction_nm_s_rad),
            ratio: number("reduction_ratio", mechanics.ratio),
            stiffness_nm_rad: number("stiffness_nm_rad", mechanics.stiffness_nm_rad),
            dead_zone_rad: number("dead_zone_rad", mechanics.dead_zone_rad),
        },
        shaft: ShaftParameters {
            shaft_damping_nm_s_rad: number("shaft_damping_nm_s_rad", shaft.shaft_damping_nm_s_rad),
            load: stribeck(["load_coulomb_nm", "load_stiction_nm", "load_stribeck_rad_s"], shaft.load),
            load_asymmetry: plant.number("load_friction_asymmetry").unwrap_or(shaft.load_asymmetry),
            motor: stribeck(["motor_coulomb_nm", "motor_stiction_nm", "motor_stribeck_rad_s"], shaft.motor),
            current_lag_s: number("current_lag_ms", 1e3 * shaft.current_lag_s) / 1e3,
            torque_offset_nm: plant.number("torque_offset_nm").unwrap_or(shaft.torque_offset_nm),
            ..shaft
        },
    }
}
