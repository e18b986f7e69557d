//! The limits of a rig, held against a scenario: parameters before anything is opened, the reference before the drive moves.

use std::path::{Path, PathBuf};

use lashloop_bench::scenario::controller::{ParameterSetting, ParameterValue};
use lashloop_bench::scenario::{RunMode, Scenario, ScenarioError, ScenarioErrors};
use lashloop_plant::reference::Reference;
use lashloop_protocol::parameter_names::{TORQUE_LIMIT_NM, WATCHDOG_US};

use super::file::{Limits, Rig};

/// Parameter of a drive with pins.
const TWIST_LIMIT_RAD: &str = "twist_limit_rad";

/// What becomes of a parameter or a travel beyond the limits of a rig.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Excess {
    /// It is an error.
    Rejected,
    /// A parameter is reduced to its limit. The caller ends a motion that leaves the travel, which counts from where the load
    /// stands at the first one; `commission` moves loads whose zero isn't known.
    Guarded,
}

/// A limit of the rig that is a parameter of the drive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DriveLimit {
    /// Key in the rig file.
    pub key: &'static str,
    /// Parameter of the drive.
    pub parameter: &'static str,
    /// Largest value of the parameter.
    pub largest: f64,
    pub unit: &'static str,
}

/// A scenario that exceeds the limits of a rig.
#[derive(Debug, thiserror::Error)]
pub enum LimitError {
    /// Parameters of the drive beyond the limits, each at its place in the scenario.
    #[error(transparent)]
    Parameters(#[from] ScenarioErrors),
    /// The reference leaves the travel, or moves too fast.
    #[error(
        "{scenario}: the reference reaches {reached:.6} {unit}; {} allows limits.{key} = {largest} {unit}: change [reference], \
         or the rig file if the bench allows more",
        rig.display()
    )]
    Reference {
        /// The scenario as the user named it.
        scenario: String,
        /// The rig file.
        rig: PathBuf,
        /// Key of the limit.
        key: &'static str,
        reached: f64,
        largest: f64,
        unit: &'static str,
    },
    /// The amplifier has no scale.
    #[error(
        "{}: power_stage.torque_per_duty_nm is missing: bench mode needs the scale of this amplifier, and that of a scenario \
         belongs to another one; measure it, or take it from the amplifier's settings",
        rig.display()
    )]
    NoScale {
        /// The rig file.
        rig: PathBuf,
    },
}

impl Rig {
    /// Checks what a scenario sets, before anything is opened. Whether its reference is a position isn't known yet.
    ///
    /// # Errors
    /// As `check_parameters`; in bench mode the rig needs the scale of its amplifier, unless the drive makes the torque by a bridge.
    pub fn allows(&self, scenario: &Scenario) -> Result<(), LimitError> {
        let makes_torque = |it: &ParameterSetting| {
            it.name == "torque_source" && it.value != ParameterValue::Text("amplifier".to_owned())
        };
        let mut settings = scenario.controller.parameters.iter().chain(&scenario.bench.parameters);
        let has_amplifier = !settings.any(makes_torque);
        if has_amplifier && !scenario.run.mode.is_hil() && self.power_stage.torque_per_duty_nm.is_none() {
            return Err(LimitError::NoScale { rig: self.file.clone() });
        }
        self.limits.check_parameters(scenario, &self.file)
    }
}

impl Limits {
    /// The limits that are parameters of the drive in this mode.
    #[must_use]
    pub fn of_drive(&self, mode: RunMode) -> Vec<DriveLimit> {
        let limit = |key, parameter, largest, unit| DriveLimit { key, parameter, largest, unit };
        let speeds = [
            ("limits.motor_speed_rad_s", "motor_speed_limit_rad_s", self.motor_speed_rad_s),
            ("limits.load_speed_rad_s", "load_speed_limit_rad_s", self.load_speed_rad_s),
        ];
        let speeds = speeds
            .into_iter()
            .filter_map(|(key, parameter, largest)| Some(limit(key, parameter, largest?, "rad/s")));
        let of_pins = [
            limit("limits.watchdog_us", WATCHDOG_US, self.watchdog_us.into(), "us"),
            limit("limits.twist_rad", TWIST_LIMIT_RAD, self.twist_rad, "rad"),
        ];
        [limit("limits.torque_nm", TORQUE_LIMIT_NM, self.torque_nm, "N m")]
            .into_iter()
            .chain(speeds)
            .chain(of_pins.into_iter().filter(|_| mode == RunMode::Bench))
            .collect()
    }

    /// Reduces what a scenario exceeds to the limits, for a scenario of this program that fits other benches too. Returns a
    /// sentence for each parameter.
    pub fn reduce(&self, scenario: &mut Scenario) -> Vec<String> {
        let limits = self.of_drive(scenario.run.mode);
        let settings = scenario.controller.parameters.iter_mut().chain(&mut scenario.bench.parameters);
        let mut reduced = Vec::new();
        for setting in settings {
            let limit = limits.iter().find(|limit| limit.parameter == setting.name);
            if let (Some(limit), ParameterValue::Number(number)) = (limit, &mut setting.value)
                && *number > limit.largest
            {
                let DriveLimit { key, largest, unit, .. } = limit;
                reduced.push(format!("{} is {largest} {unit} by {key}, not {number}", setting.name));
                *number = *largest;
            }
        }
        reduced
    }

    /// Checks the parameters of a scenario. `rig` is the rig file, for messages.
    ///
    /// # Errors
    /// Every parameter beyond its limit.
    pub(crate) fn check_parameters(&self, scenario: &Scenario, rig: &Path) -> Result<(), LimitError> {
        let limits = self.of_drive(scenario.run.mode);
        let settings = scenario.controller.parameters.iter().chain(&scenario.bench.parameters);
        let exceeded = settings.filter_map(|setting| {
            let limit = limits.iter().find(|limit| limit.parameter == setting.name)?;
            Some(ScenarioError::parameter(setting, limit.exceeded_by(setting, rig)?))
        });
        let exceeded: Vec<_> = exceeded.collect();
        if exceeded.is_empty() { Ok(()) } else { Err(ScenarioErrors::from(exceeded).into()) }
    }

    /// Checks the reference of a scenario whose law takes it as a position. `rig` is the rig file, for messages.
    ///
    /// # Errors
    /// The first limit that the reference exceeds.
    pub(crate) fn check_reference(&self, scenario: &Scenario, rig: &Path) -> Result<(), LimitError> {
        let extremes = Extremes::of(scenario);
        let error = |key, reached, largest, unit| LimitError::Reference {
            scenario: scenario.name.clone(),
            rig: rig.to_owned(),
            key,
            reached,
            largest,
            unit,
        };
        if extremes.distance_rad > self.load_travel_rad {
            return Err(error("load_travel_rad", extremes.distance_rad, self.load_travel_rad, "rad"));
        }
        match self.load_speed_rad_s {
            Some(largest) if extremes.speed_rad_s > largest => {
                Err(error("load_speed_rad_s", extremes.speed_rad_s, largest, "rad/s"))
            }
            _ => Ok(()),
        }
    }
}

impl DriveLimit {
    /// The reason against a value beyond the limit.
    fn exceeded_by(&self, setting: &ParameterSetting, rig: &Path) -> Option<String> {
        let Self { key, largest, unit, .. } = self;
        match setting.value {
            ParameterValue::Number(number) if number > *largest => {
                Some(format!("exceeds the rig; {} allows {key} = {largest} {unit}", rig.display()))
            }
            _ => None,
        }
    }
}

/// The extremes of a reference during a run.
struct Extremes {
    /// Distance from zero.
    distance_rad: f64,
    /// Speed between two control periods. A step has none: torque limit and law decide how fast the load follows.
    speed_rad_s: f64,
}

impl Extremes {
    fn of(scenario: &Scenario) -> Self {
        let Scenario { reference, run, .. } = scenario;
        let is_step = match reference {
            Reference::Step { .. } | Reference::Constant { .. } => true,
            Reference::Sine { .. }
            | Reference::Trapezoid(_)
            | Reference::Chirp(_)
            | Reference::Multisine(_)
            | Reference::Table(_) => false,
        };
        let period_s = run.control_period_s();
        let mut extremes = Self { distance_rad: 0.0, speed_rad_s: 0.0 };
        let mut before_rad = None;
        for step in 0..run.steps() {
            let position_rad = reference.position_rad(f64::from(step) * period_s);
            extremes.distance_rad = extremes.distance_rad.max(position_rad.abs());
            if let Some(before_rad) = before_rad.replace(position_rad).filter(|_| !is_step) {
                let speed_rad_s = (position_rad - before_rad).abs() / period_s;
                extremes.speed_rad_s = extremes.speed_rad_s.max(speed_rad_s);
            }
        }
        extremes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scenario(settings: &[&str]) -> Scenario {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/shaft-pd-sine.toml");
        crate::Bench::new().scenario(path, settings).expect("a scenario")
    }

    fn limits() -> Limits {
        Limits {
            torque_nm: 1000.0,
            motor_speed_rad_s: None,
            load_speed_rad_s: None,
            load_travel_rad: 10.0,
            watchdog_us: 50_000,
            twist_rad: 20.0,
        }
    }

    fn check(limits: &Limits, settings: &[&str]) -> Result<(), String> {
        let (scenario, rig) = (scenario(settings), Path::new("rig.toml"));
        let checked = limits.check_parameters(&scenario, rig);
        checked.and_then(|()| limits.check_reference(&scenario, rig)).map_err(|error| error.to_string())
    }

    #[test]
    fn a_limit_of_the_scenario_above_the_rig_is_named_with_both() {
        let limits = Limits { torque_nm: 5.0, motor_speed_rad_s: Some(90.0), ..limits() };
        let set =
            ["controller.parameters.torque_limit_nm=5", "controller.parameters.motor_speed_limit_rad_s=90"];
        assert_eq!(check(&limits, &set), Ok(()));
        let set = [
            "controller.parameters.torque_limit_nm=5.01",
            "controller.parameters.motor_speed_limit_rad_s=91",
        ];
        let errors = check(&limits, &set).expect_err("beyond both limits");
        assert!(errors.contains("rig.toml allows limits.torque_nm = 5 N m"), "{errors}");
        assert!(errors.contains("rig.toml allows limits.motor_speed_rad_s = 90 rad/s"), "{errors}");
    }

    #[test]
    fn watchdog_and_twist_are_limited_in_bench_mode_only() {
        let scenario = |mode: &str, set: &[&str]| {
            let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/bench-smooth-after.toml");
            let mode = format!("run.mode={mode}");
            crate::Bench::new().scenario(path, &[&[&*mode], set].concat()).expect("a scenario")
        };
        let check = |scenario: &Scenario| limits().check_parameters(scenario, Path::new("rig.toml"));
        let watchdog = ["controller.parameters.watchdog_us=60000"];
        assert!(check(&scenario("hil", &watchdog)).is_ok() && check(&scenario("bench", &[])).is_ok());
        for (set, key) in [
            (watchdog, "limits.watchdog_us = 50000 us"),
            (["bench.twist_limit_rad=20.1"], "limits.twist_rad = 20 rad"),
        ] {
            let error = check(&scenario("bench", &set)).expect_err("beyond the rig").to_string();
            assert!(error.contains(key), "{error}");
        }
    }

    #[test]
    fn a_reduced_scenario_is_allowed_and_keeps_what_was_within() {
        let limits = Limits { torque_nm: 5.0, motor_speed_rad_s: Some(90.0), ..limits() };
        let set = [
            "controller.parameters.torque_limit_nm=5.01",
            "controller.parameters.motor_speed_limit_rad_s=80",
        ];
        let mut scenario = scenario(&set);
        let notes = limits.reduce(&mut scenario);
        assert_eq!(notes, ["torque_limit_nm is 5 N m by limits.torque_nm, not 5.01"]);
        assert!(limits.check_parameters(&scenario, Path::new("rig.toml")).is_ok());
        assert!(limits.reduce(&mut scenario).is_empty());
    }

    const SINE: [&str; 6] = [
        "plant.initial.load_position_rad=0",
        "plant.initial.motor_position_rad=0",
        "reference.profile=sine",
        "reference.amplitude_rad=0.5",
        "reference.offset_rad=0",
        "reference.frequency_hz=0.5",
    ];

    #[test]
    fn a_reference_beyond_the_travel_is_rejected() {
        assert_eq!(check(&Limits { load_travel_rad: 0.51, ..limits() }, &SINE), Ok(()));
        let error = check(&Limits { load_travel_rad: 0.49, ..limits() }, &SINE).expect_err("0.5 rad");
        assert!(
            error.contains("reaches 0.500000 rad; rig.toml allows limits.load_travel_rad = 0.49 rad"),
            "{error}"
        );
    }

    #[test]
    fn a_reference_beyond_the_speed_is_rejected_and_a_step_is_not() {
        // The peak is 2 pi f A = 1.5708 rad/s.
        let fast = |limit| Limits { load_speed_rad_s: Some(limit), ..limits() };
        assert_eq!(check(&fast(1.58), &SINE), Ok(()));
        let error = check(&fast(1.56), &SINE).expect_err("1.57 rad/s");
        assert!(error.contains("allows limits.load_speed_rad_s = 1.56 rad/s"), "{error}");
        let mut step = scenario(&[]);
        step.reference = Reference::Step { before_rad: 0.0, after_rad: 1.0, at_s: 0.5 };
        assert!(fast(0.1).check_reference(&step, Path::new("rig.toml")).is_ok());
    }
}
