//! The control laws under test.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use lashloop_bench::scenario::present_law;

/// The scenario of each law: name of the law, name of the file, text. Its controller parameters are tuned for the nominal
/// plant and stay unchanged.
const SCENARIOS: [(&str, &str, &str); Law::COUNT] = [
    ("pd", "scenarios/shaft-pd.toml", include_str!("../../../scenarios/shaft-pd.toml")),
    ("merzouki", "scenarios/shaft-merzouki.toml", include_str!("../../../scenarios/shaft-merzouki.toml")),
    (
        "backlash-inverse",
        "scenarios/shaft-backlash-inverse.toml",
        include_str!("../../../scenarios/shaft-backlash-inverse.toml"),
    ),
    (
        "braking-curve",
        "scenarios/shaft-braking-curve.toml",
        include_str!("../../../scenarios/shaft-braking-curve.toml"),
    ),
];

/// A law under test: the place of its scenario in the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Law(usize);

impl Law {
    const COUNT: usize = 4;

    /// In the order of the tables.
    pub const ALL: [Self; Self::COUNT] =
        [Self::BEFORE, Self::AFTER, Self::BACKLASH_INVERSE, Self::BRAKING_CURVE];

    /// The paper's law before compensation.
    pub const BEFORE: Self = Self(0);
    /// The paper's compensation.
    pub const AFTER: Self = Self(1);
    pub const BACKLASH_INVERSE: Self = Self(2);
    pub const BRAKING_CURVE: Self = Self(3);

    /// Name, as the drive describes it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        SCENARIOS[self.0].0
    }

    /// File name and text of the law's scenario.
    #[must_use]
    pub const fn scenario(self) -> (&'static str, &'static str) {
        let (_, file, text) = SCENARIOS[self.0];
        (file, text)
    }
}

impl fmt::Display for Law {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.pad(self.name())
    }
}

impl FromStr for Law {
    type Err = String;

    /// Former names of laws are accepted as in scenarios.
    fn from_str(text: &str) -> Result<Self, String> {
        let law = Self::ALL.into_iter().find(|law| law.name() == present_law(text));
        law.ok_or_else(|| {
            let [others @ .., last] = Self::ALL.map(Self::name);
            format!("expected {} or {last}", others.join(", "))
        })
    }
}

impl Serialize for Law {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

impl<'de> Deserialize<'de> for Law {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let name = String::deserialize(deserializer)?;
        name.parse().map_err(|expected| serde::de::Error::custom(format!("unknown law `{name}`, {expected}")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn former_names_of_laws_are_accepted() {
        assert_eq!("faithful".parse::<Law>().map(Law::name), Ok("merzouki"));
        assert_eq!("compensating".parse(), Ok(Law::BACKLASH_INVERSE));
        let expected = "expected pd, merzouki, backlash-inverse or braking-curve";
        assert_eq!("lqr".parse::<Law>(), Err(expected.to_owned()));
    }
}
