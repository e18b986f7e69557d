//! What contradicts itself in a drive's identity and description. Such a drive runs, but not as its author believes.

use std::collections::BTreeSet;

use lashloop_protocol::enums::{Capabilities, ParameterValue};
use lashloop_protocol::parameter_names::{
    LOAD_COUNTS_PER_REV, MOTOR_COUNTS_PER_REV, PERIOD_US, SAMPLE_SOURCE,
};

use crate::client::Session;

impl Session {
    /// What contradicts itself in the drive's identity and description, each in a sentence.
    #[must_use]
    pub fn oddities(&self) -> Vec<String> {
        let mut oddities = Vec::new();
        let offers_bench = self.identity.capabilities.contains(Capabilities::BENCH_MODE);
        let has_pins = self.parameter(SAMPLE_SOURCE).is_some();
        match (offers_bench, has_pins) {
            (true, false) => oddities.push(format!(
                "the drive's Identity has the capability BENCH_MODE, and no parameter is {SAMPLE_SOURCE}: it has no bench mode"
            )),
            (false, true) => oddities.push(format!(
                "the drive has the parameter {SAMPLE_SOURCE}, and its Identity lacks the capability BENCH_MODE"
            )),
            (true, true) | (false, false) => {}
        }
        // Before a reset the values of an earlier host may be in force.
        if self.is_reset {
            oddities.extend(self.other_values());
        }
        let signals = self.signals.iter().map(|it| &*it.signal.name);
        oddities.extend(duplicates("signals", signals));
        oddities.extend(duplicates("laws", self.laws.iter().map(|it| &*it.name)));
        oddities.extend(duplicates("parameters", self.parameters.iter().map(|it| &*it.name)));
        oddities
    }

    /// Values of the identity after a reset that aren't those of the parameters.
    fn other_values(&self) -> impl Iterator<Item = String> {
        let identity = &self.identity;
        let values = [
            (PERIOD_US, identity.period_us),
            (MOTOR_COUNTS_PER_REV, identity.motor_counts_per_rev),
            (LOAD_COUNTS_PER_REV, identity.load_counts_per_rev),
        ];
        values.into_iter().filter_map(|(name, value)| {
            let default = self.parameter(name)?.default;
            let number = match default {
                ParameterValue::U32(number) => f64::from(number),
                ParameterValue::F32(number) => number.into(),
                ParameterValue::Unknown { .. } => return None,
            };
            // Rounded up or down in the identity.
            let is_same = (f64::from(value) - number).abs() < 1.0;
            (!is_same).then(|| {
                format!(
                    "the drive's Identity has {name} {value}, and the parameter is {default} after a reset"
                )
            })
        })
    }
}

fn duplicates<'a>(what: &str, names: impl Iterator<Item = &'a str>) -> Option<String> {
    let (mut seen, mut twice) = (BTreeSet::new(), BTreeSet::new());
    for name in names {
        if !seen.insert(name) {
            twice.insert(name);
        }
    }
    let twice: Vec<_> = twice.into_iter().collect();
    (!twice.is_empty()).then(|| format!("several {what} of the drive are named {}", twice.join(" and ")))
}

#[cfg(test)]
mod tests {
    use lashloop_firmware::Laws;
    use lashloop_link::in_process::InProcess;

    use super::*;

    fn session() -> Session {
        Session::open(Box::new(InProcess::<Laws>::default()), 1).expect("a drive")
    }

    #[test]
    fn the_drive_in_process_is_not_odd() {
        let mut session = session();
        assert_eq!(session.oddities(), [""; 0]);
        session.set("motor_counts_per_rev", 4096.0).expect("a resolution");
        session.reset().expect("a reset");
        assert_eq!(session.oddities(), [""; 0]);
    }

    #[test]
    fn an_identity_that_contradicts_the_parameters_is_odd() {
        let mut session = session();
        session.reset().expect("a reset");
        session.identity.period_us += 1;
        session.identity.capabilities.toggle(Capabilities::BENCH_MODE);
        let oddities = session.oddities();
        assert!(oddities.len() == 2 && oddities[0].contains("BENCH_MODE"), "{oddities:?}");
        assert!(oddities[1].contains("Identity has period_us"), "{oddities:?}");
    }

    #[test]
    fn names_that_occur_twice_are_odd() {
        let mut session = session();
        let name = session.parameters[1].name.clone();
        session.parameters[0].name.clone_from(&name);
        session.laws[0].name = session.laws[1].name.clone();
        let oddities = session.oddities();
        assert_eq!(oddities.len(), 2, "{oddities:?}");
        assert_eq!(oddities[1], format!("several parameters of the drive are named {name}"));
    }
}
