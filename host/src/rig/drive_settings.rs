//! What a rig sets on its drive, as parameters of the scenario: limits, encoders and power stage.
//!
//! A drive offers the parameters that its pins need. A drive without pins lacks them, and then nothing is set.

use lashloop_bench::scenario::controller::{ParameterSetting, ParameterValue};
use lashloop_bench::scenario::{Origin, RunMode, Scenario};
use lashloop_bench::session::Parameter;
use lashloop_protocol::enums::ParameterValue as WireValue;

use super::file::{Direction, Level, Rig};

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

impl Rig {
    /// The parameters that describe the pins: name and value.
    #[must_use]
    pub fn pins(&self) -> Vec<(&'static str, ParameterValue)> {
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
        let level = |level: Option<Level>| {
            level.map(|level| {
                ParameterValue::Text(match level {
                    Level::High => "high".to_owned(),
                    Level::Low => "low".to_owned(),
                })
            })
        };
        let torque_direction = power_stage
            .torque_per_duty_nm
            .map(|scale| if scale < 0.0 { Direction::Reversed } else { Direction::Normal });
        let pins = [
            ("torque_per_duty_nm", number(power_stage.torque_per_duty_nm.map(f64::abs))),
            ("torque_direction", direction(torque_direction)),
            ("duty_offset", number(power_stage.duty_offset)),
            ("duty_min", number(power_stage.duty_min)),
            ("duty_max", number(power_stage.duty_max)),
            ("enable_level", level(power_stage.enable_level)),
            ("fault_level", level(power_stage.fault_level)),
            ("motor_direction", direction(encoders.motor_direction)),
            ("load_direction", direction(encoders.load_direction)),
        ];
        pins.into_iter().filter_map(|(name, value)| Some((name, value?))).collect()
    }

    /// Completes a scenario that keeps the limits: a limit that it leaves to the drive becomes the smaller of the drive's
    /// default and the limit of the rig, and a drive with pins gets their settings. In bench mode the encoders are those of the
    /// rig. `parameters` are those of the drive.
    ///
    /// # Errors
    /// The drive lacks the parameter of a limit.
    pub fn complete(
        &self,
        scenario: &mut Scenario,
        parameters: &[Parameter],
    ) -> Result<(), MissingParameter> {
        let origin = Origin::Option(format!("--rig {}", self.file.display()).into());
        let settings = &mut scenario.controller.parameters;
        let is_set = |settings: &[ParameterSetting], name: &str| settings.iter().any(|it| it.name == name);
        let find = |name: &str| parameters.iter().find(|parameter| parameter.name == name);
        for limit in self.limits.of_drive() {
            let missing = MissingParameter { parameter: limit.parameter, key: limit.key };
            let default = number(find(limit.parameter).ok_or(missing)?.default);
            if !is_set(settings, limit.parameter) {
                let value = ParameterValue::Number(limit.largest.min(default));
                let (name, origin) = (limit.parameter.to_owned(), origin.clone());
                settings.push(ParameterSetting { name, value, origin });
            }
        }
        if scenario.run.mode == RunMode::Bench {
            let encoders = &mut scenario.encoders;
            for (counts, of_rig) in [
                (&mut encoders.motor_counts_per_rev, self.encoders.motor_counts_per_rev),
                (&mut encoders.load_counts_per_rev, self.encoders.load_counts_per_rev),
            ] {
                *counts = of_rig.unwrap_or(*counts);
            }
        }
        for (name, value) in self.pins() {
            if find(name).is_some() {
                settings.retain(|setting| setting.name != name);
                settings.push(ParameterSetting { name: name.to_owned(), value, origin: origin.clone() });
            }
        }
        Ok(())
    }
}

fn number(value: WireValue) -> f64 {
    match value {
        WireValue::U32(number) => number.into(),
        WireValue::F32(number) => number.into(),
    }
}

#[cfg(test)]
mod tests {
    use lashloop_bench::session::LawMask;

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
    fn pins_are_set_on_a_drive_that_has_them_only() {
        let limit = parameter("torque_limit_nm", 3.0);
        assert_eq!(completed(&[], std::slice::from_ref(&limit)).len(), 1);
        let with_pins = completed(&[], &[limit, parameter("motor_direction", 0.0)]);
        let direction = ParameterValue::Text("reverse".to_owned());
        assert_eq!(with_pins[1], ("motor_direction".to_owned(), direction));
    }

    #[test]
    fn a_negative_scale_reverses_the_power_stage() {
        let text = RIG.replace("[encoders]", "[power_stage]\ntorque_per_duty_nm = -6.4\n[encoders]");
        let rig = Rig::from_str("rig.toml", &text).unwrap_or_else(|errors| panic!("{errors}"));
        let pins = rig.pins();
        assert!(pins.contains(&("torque_per_duty_nm", ParameterValue::Number(6.4))), "{pins:?}");
        assert!(pins.contains(&("torque_direction", ParameterValue::Text("reverse".to_owned()))), "{pins:?}");
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
            rig.complete(&mut scenario, &[parameter("torque_limit_nm", 3.0)]).expect("a torque limit");
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
