//! What a rig sets on its drive, as parameters of the scenario: limits, encoders and power stage.
//!
//! A drive offers the parameters that its pins need. A drive without pins lacks them: in bench mode that is an error. HIL mode
//! uses no pins, so none is set there.

use lashloop_bench::scenario::bench::key_of_pin;
use lashloop_bench::scenario::controller::{ParameterSetting, ParameterValue};
use lashloop_bench::scenario::declare::Named as _;
use lashloop_bench::scenario::{Origin, Scenario};
use lashloop_protocol::enums::ParameterValue as WireValue;
use lashloop_session::Parameter;

use super::file::{Direction, Rig};

/// A parameter that the drive of a rig must have.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "the drive has no parameter {parameter}, so it can't keep {key} of the rig file: flash firmware that has it, or remove the key"
)]
pub struct MissingParameter {
    /// Name of the parameter.
    pub parameter: &'static str,
    /// Key of the rig file.
    pub key: &'static str,
}

/// A key of the rig file that is a parameter of a drive with pins.
#[derive(Debug, Clone, PartialEq)]
pub struct PinSetting {
    pub key: &'static str,
    pub parameter: &'static str,
    pub value: ParameterValue,
}

/// Origin of what `lashloop commission` sets by itself. A rig doesn't replace it.
pub const COMMISSION: &str = "lashloop commission";

/// Parameters that describe the pins.
const OF_PINS: [&str; 10] = [
    "torque_per_duty_nm",
    "torque_direction",
    "duty_offset",
    "duty_min",
    "duty_max",
    "stage_mode",
    "pwm_frequency_hz",
    "motor_direction",
    "load_direction",
    "encoder_filter_ns",
];

impl Rig {
    /// The parameters that describe the pins, as far as the file has them.
    #[must_use]
    pub fn pins(&self) -> Vec<PinSetting> {
        let Self { encoders, power_stage, .. } = self;
        let number = |number: Option<f64>| number.map(ParameterValue::Number);
        let direction = |direction: Option<Direction>| {
            direction.map(|direction| {
                ParameterValue::Text(match direction {
                    Direction::Normal => "forward".to_owned(),
                    Direction::Reversed => "reverse".to_owned(),
                })
            })
        };
        let torque_direction = power_stage
            .torque_per_duty_nm
            .map(|scale| if scale < 0.0 { Direction::Reversed } else { Direction::Normal });
        let scale = "power_stage.torque_per_duty_nm";
        let pins = [
            (scale, number(power_stage.torque_per_duty_nm.map(f64::abs))),
            (scale, direction(torque_direction)),
            ("power_stage.duty_offset", number(power_stage.duty_offset)),
            ("power_stage.duty_min", number(power_stage.duty_min)),
            ("power_stage.duty_max", number(power_stage.duty_max)),
            (
                "power_stage.mode",
                power_stage.mode.map(|mode| ParameterValue::Text(mode.choice().name.to_owned())),
            ),
            ("power_stage.frequency_hz", number(power_stage.frequency_hz.map(f64::from))),
            ("encoders.motor_direction", direction(encoders.motor_direction)),
            ("encoders.load_direction", direction(encoders.load_direction)),
            ("encoders.filter_ns", number(encoders.filter_ns.map(f64::from))),
        ];
        let setting = |(parameter, (key, value)): (_, (_, Option<_>))| {
            Some(PinSetting { key, parameter, value: value? })
        };
        OF_PINS.into_iter().zip(pins).filter_map(setting).collect()
    }

    /// Gives a scenario in bench mode the resolution of the rig's encoders and its travel.
    pub fn equip(&self, scenario: &mut Scenario) {
        if scenario.run.mode.is_hil() {
            return;
        }
        let encoders = &mut scenario.encoders;
        for (counts, of_rig) in [
            (&mut encoders.motor_counts_per_rev, self.encoders.motor_counts_per_rev),
            (&mut encoders.load_counts_per_rev, self.encoders.load_counts_per_rev),
        ] {
            *counts = of_rig.unwrap_or(*counts);
        }
        let travel_rad = &mut scenario.bench.load_travel_limit_rad;
        *travel_rad =
            Some(travel_rad.map_or(self.limits.load_travel_rad, |own| own.min(self.limits.load_travel_rad)));
    }

    /// Completes a scenario that keeps the limits: a limit that it leaves to the drive becomes the smaller of the drive's
    /// default and the limit of the rig, and in bench mode the pins get the settings of the rig. [`equip`](Self::equip) is part
    /// of it. `parameters` are those of the drive.
    ///
    /// # Errors
    /// The drive lacks the parameter of a limit, or in bench mode that of a pin.
    pub fn complete(
        &self,
        scenario: &mut Scenario,
        parameters: &[Parameter],
    ) -> Result<(), MissingParameter> {
        let origin = Origin::Option(format!("--rig {}", self.file.display()).into());
        self.equip(scenario);
        let mode = scenario.run.mode;
        // A key that the rig file lacks leaves the drive's default, not the amplifier or the encoders of the scenario.
        let is_own = |origin: &Origin| matches!(origin, Origin::Option(option) if **option == *COMMISSION);
        scenario.bench.parameters.retain(|it| !OF_PINS.contains(&&*it.name) || is_own(&it.origin));
        let find = |name: &str| parameters.iter().find(|parameter| parameter.name == name);
        let mut set = |name: &str, value, is_of_pins: bool| {
            let (section, of) = if is_of_pins {
                ("bench", &mut scenario.bench.parameters)
            } else {
                ("controller.parameters", &mut scenario.controller.parameters)
            };
            if !of.iter().any(|it| it.name == name) {
                of.push(ParameterSetting { section, name: name.to_owned(), value, origin: origin.clone() });
            }
        };
        for limit in self.limits.of_drive(mode) {
            let missing = MissingParameter { parameter: limit.parameter, key: limit.key };
            let default = number(find(limit.parameter).ok_or(missing)?.default);
            let value = ParameterValue::Number(limit.largest.min(default));
            set(limit.parameter, value, key_of_pin(limit.parameter).is_some());
        }
        let pins = if mode.is_hil() { Vec::new() } else { self.pins() };
        for PinSetting { key, parameter, value } in pins {
            find(parameter).ok_or(MissingParameter { parameter, key })?;
            set(parameter, value, true);
        }
        Ok(())
    }
}

fn number(value: WireValue) -> f64 {
    match value {
        WireValue::U32(number) => number.into(),
        WireValue::F32(number) => number.into(),
        WireValue::Unknown { .. } => f64::NAN,
    }
}

#[cfg(test)]
mod tests {
    use lashloop_bench::atomic_file::WriteError;
    use lashloop_bench::run::{Clock, DeviceUnderTest, RunError, Step, StepObserver, run};
    use lashloop_bench::supervisor::Supervisor;
    use lashloop_bench::timing::ClockName;
    use lashloop_firmware::drive::PinParameters;
    use lashloop_firmware::law::ParameterGroup as _;
    use lashloop_session::LawMask;

    use super::*;

    const RIG: &str = "title = \"t\"\ncontact = \"c\"\nboard = \"b\"\n[port]\ndevice = \"/dev/serial/by-id/x\"\n\
                       [limits]\ntorque_nm = 5.0\nload_travel_rad = 4.0\n[encoders]\nmotor_direction = \"reversed\"\n";

    fn rig() -> Rig {
        Rig::from_str("rig.toml", RIG).unwrap_or_else(|errors| panic!("{errors}"))
    }

    fn parameter(name: &str, default: f32) -> Parameter {
        let [min, max] = [0.0, 1000.0].map(WireValue::F32);
        Parameter {
            index: 0,
            name: name.to_owned(),
            unit: String::new(),
            default: WireValue::F32(default),
            min,
            max,
            live: false,
            laws: LawMask(0),
            choices: Vec::new(),
        }
    }

    /// The parameters of a scenario that sets `own`, once the rig has completed it for a drive with these.
    fn completed(own: &[&str], parameters: &[Parameter]) -> Vec<(String, ParameterValue)> {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/smooth-after.toml");
        let mut scenario = crate::Bench::new().scenario(path, own).expect("a scenario");
        scenario.controller.parameters.retain(|it| matches!(it.origin, Origin::Option(_)));
        rig().complete(&mut scenario, parameters).expect("the drive has the parameters");
        scenario.controller.parameters.into_iter().map(|it| (it.name, it.value)).collect()
    }

    #[test]
    fn an_absent_limit_becomes_the_smaller_of_default_and_rig() {
        let limit = |default| {
            let parameters = completed(&[], &[parameter("torque_limit_nm", default)]);
            parameters[..]
                == [("torque_limit_nm".to_owned(), ParameterValue::Number(f64::from(default.min(5.0))))]
        };
        assert!(limit(20.0) && limit(3.0));
        let own = ["controller.parameters.torque_limit_nm=4"];
        let kept = completed(&own, &[parameter("torque_limit_nm", 20.0)]);
        assert_eq!(kept, [("torque_limit_nm".to_owned(), ParameterValue::Number(4.0))]);
    }

    #[test]
    fn the_travel_of_a_scenario_is_at_most_that_of_the_rig() {
        let travel_rad = |own: &[&str]| {
            let path =
                std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/bench-smooth-after.toml");
            let mut scenario = crate::Bench::new().scenario(path, own).expect("a scenario");
            rig().equip(&mut scenario);
            scenario.bench.load_travel_limit_rad
        };
        assert_eq!(travel_rad(&[]), Some(4.0));
        assert_eq!(travel_rad(&["bench.load_travel_limit_rad=5"]), Some(4.0));
        assert_eq!(travel_rad(&["bench.load_travel_limit_rad=3"]), Some(3.0));
    }

    #[test]
    fn the_settings_of_the_pins_are_those_of_the_rig_in_bench_mode_only() {
        let path =
            std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/bench-smooth-after.toml");
        let drive = ["torque_limit_nm", "watchdog_us", "twist_limit_rad", "motor_direction"];
        for (mode, want) in [("bench", Some("reverse")), ("hil", None)] {
            let own = [&*format!("run.mode={mode}"), "bench.motor_direction=forward"];
            let mut scenario = crate::Bench::new().scenario(&path, &own).expect("a scenario");
            rig()
                .complete(&mut scenario, &drive.map(|name| parameter(name, 3.0)))
                .expect("a drive with pins");
            let of_pins = scenario.bench.parameters.iter().find(|it| it.name == "motor_direction");
            let want = want.map(|name| ParameterValue::Text(name.to_owned()));
            assert_eq!(of_pins.map(|it| it.value.clone()), want, "{mode}");
        }
    }

    #[test]
    fn a_negative_scale_reverses_the_power_stage() {
        let text = RIG.replace("[encoders]", "[power_stage]\ntorque_per_duty_nm = -6.4\n[encoders]");
        let rig = Rig::from_str("rig.toml", &text).unwrap_or_else(|errors| panic!("{errors}"));
        let pins = rig.pins();
        let has = |parameter, value| pins.iter().any(|it| it.parameter == parameter && it.value == value);
        assert!(has("torque_per_duty_nm", ParameterValue::Number(6.4)), "{pins:?}");
        assert!(has("torque_direction", ParameterValue::Text("reverse".to_owned())), "{pins:?}");
    }

    /// A rig with every key of a pin.
    fn with_every_pin() -> Rig {
        let text = RIG.replace(
            "[encoders]\n",
            "[power_stage]\ntorque_per_duty_nm = 62.5\nduty_offset = 0.5\nduty_min = 0.1\nduty_max = 0.9\n\
             mode = \"amplifier\"\nfrequency_hz = 5000\n[encoders]\nload_direction = \"normal\"\nfilter_ns = 35\n",
        );
        Rig::from_str("rig.toml", &text).unwrap_or_else(|errors| panic!("{errors}"))
    }

    #[test]
    fn every_key_of_a_pin_is_a_parameter_of_a_drive_with_pins() {
        let keys = Rig::keys().to_page("");
        for PinSetting { key, parameter, .. } in with_every_pin().pins() {
            assert!(PinParameters::TABLE.iter().any(|it| it.name == parameter), "{parameter}");
            assert!(keys.contains(key.rsplit('.').next().expect("a name")), "{key}");
        }
    }

    #[test]
    fn pins_that_the_rig_file_lacks_are_the_drives_and_not_the_scenarios() {
        let path =
            std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/bench-smooth-after.toml");
        let own = ["bench.duty_offset=0.45", "bench.load_direction=reverse", "bench.twist_limit_rad=4"];
        let mut scenario = crate::Bench::new().scenario(path, &own).expect("a scenario");
        let names = ["torque_limit_nm", "watchdog_us", "twist_limit_rad", "motor_direction"];
        rig().complete(&mut scenario, &names.map(|name| parameter(name, 3.0))).expect("a drive with pins");
        let of_bench: Vec<_> = scenario.bench.parameters.iter().map(|it| it.name.as_str()).collect();
        assert!(
            !of_bench.iter().any(|name| ["duty_offset", "load_direction"].contains(name)),
            "{of_bench:?}"
        );
        assert!(of_bench.contains(&"twist_limit_rad"), "a limit within the rig's is kept: {of_bench:?}");
    }

    #[test]
    fn a_pin_that_the_drive_lacks_is_an_error_in_bench_mode() {
        let path =
            std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/bench-smooth-after.toml");
        let mut scenario = crate::Bench::new().scenario(path, &[]).expect("a scenario");
        let drive = ["torque_limit_nm", "watchdog_us", "twist_limit_rad"].map(|name| parameter(name, 3.0));
        let error = rig().complete(&mut scenario, &drive).expect_err("no direction");
        assert_eq!((error.key, error.parameter), ("encoders.motor_direction", "motor_direction"));
    }

    /// 0.1 s of the paper's move on a drive in this process, whose amplifier has 62.5 N m per duty of 1 around 0.5.
    fn on_amplifier(rig: Option<&Rig>) -> Result<String, RunError> {
        let path =
            std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/bench-smooth-after.toml");
        let short = ["run.duration_s=0.1", "expect=[]", "controller.parameters.torque_limit_nm=5"];
        let mut scenario = crate::Bench::new().scenario(path, &short).expect("a scenario");
        let supervisor = Supervisor::without_signals(None::<std::path::PathBuf>).expect("a supervisor");
        let choice = "inproc".parse().expect("a device");
        let mut device =
            DeviceUnderTest::open(&scenario, &choice, ClockName::Lockstep, &supervisor, |link| link)?;
        if let Some(rig) = rig {
            rig.complete(&mut scenario, &device.device.session.parameters).expect("a drive with pins");
        }
        Ok(run(&scenario, &mut device, Clock::Lockstep, &mut Ignore)?.torque_sha256)
    }

    struct Ignore;

    impl StepObserver for Ignore {
        fn step(&mut self, _step: &Step) -> Result<(), WriteError> {
            Ok(())
        }
    }

    #[test]
    fn the_scale_of_a_rig_is_that_of_the_drive() {
        let mut rig = with_every_pin();
        rig.encoders.motor_direction = Some(Direction::Normal);
        let alike = on_amplifier(Some(&rig)).expect("a run");
        assert_eq!(alike, on_amplifier(None).expect("a run"));
        // The duty of each torque is half of what the amplifier needs, so the load moves otherwise.
        rig.power_stage.torque_per_duty_nm = Some(125.0);
        assert_ne!(on_amplifier(Some(&rig)).expect("a run"), alike);
        // 5 N m need a duty of 0.4 above the offset, not of 0.2.
        rig.power_stage.torque_per_duty_nm = Some(12.4);
        let error = on_amplifier(Some(&rig)).expect_err("a limit without a duty").to_string();
        assert!(error.contains("torque_limit_nm"), "{error}");
    }

    #[test]
    fn encoders_of_the_rig_replace_those_of_the_scenario_in_bench_mode_only() {
        let rig =
            Rig::from_str("rig.toml", &RIG.replace("[encoders]", "[encoders]\nmotor_counts_per_rev = 8192"));
        let rig = rig.unwrap_or_else(|errors| panic!("{errors}"));
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/smooth-after.toml");
        for (mode, want) in [("hil", 131_072), ("bench", 8192)] {
            let own = [format!("run.mode={mode}")];
            let own: Vec<_> = own.iter().map(String::as_str).collect();
            let mut scenario = crate::Bench::new().scenario(&path, &own).expect("a scenario");
            let drive = ["torque_limit_nm", "watchdog_us", "twist_limit_rad", "motor_direction"];
            rig.complete(&mut scenario, &drive.map(|name| parameter(name, 3.0))).expect("a drive with pins");
            assert_eq!(scenario.encoders.motor_counts_per_rev, want, "{mode}");
        }
    }

    #[test]
    fn a_drive_without_the_torque_limit_is_rejected() {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/smooth-after.toml");
        let mut scenario = crate::Bench::new().scenario(path, &[]).expect("a scenario");
        let error = rig().complete(&mut scenario, &[]).expect_err("no limit").to_string();
        assert!(
            error.contains("no parameter torque_limit_nm") && error.contains("limits.torque_nm"),
            "{error}"
        );
    }
}
