//! The control laws under test.

use std::str::FromStr;

use lashloop_protocol::enums::ControllerId;
use serde::{Deserialize, Serialize};

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Law {
    /// The paper's PD cascade.
    Pd,
    /// The paper's cascade with dead-zone compensation.
    Merzouki,
    /// Identification of the gap and its inversion in the torque domain.
    BacklashInverse,
}

impl Law {
    /// In the order of the tables.
    pub const ALL: [Self; 3] = [Self::Pd, Self::Merzouki, Self::BacklashInverse];

    /// File name and text of the law's scenario. Its controller parameters are tuned for the nominal plant and stay unchanged.
    #[must_use]
    pub const fn scenario(self) -> (&'static str, &'static str) {
        match self {
            Self::Pd => ("scenarios/shaft-pd.toml", include_str!("../../../scenarios/shaft-pd.toml")),
            Self::Merzouki => {
                ("scenarios/shaft-merzouki.toml", include_str!("../../../scenarios/shaft-merzouki.toml"))
            }
            Self::BacklashInverse => (
                "scenarios/shaft-backlash-inverse.toml",
                include_str!("../../../scenarios/shaft-backlash-inverse.toml"),
            ),
        }
    }
}

impl FromStr for Law {
    type Err = String;

    /// Former names of laws are accepted as in scenarios.
    fn from_str(text: &str) -> Result<Self, String> {
        let name = ControllerId::from_name(text).map_or(text, |law| law.name());
        let law = Self::ALL.into_iter().find(|law| law.to_string() == name);
        law.ok_or_else(|| "expected pd, merzouki or backlash-inverse".to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_law_has_the_name_that_drives_give_it() {
        for law in Law::ALL {
            let name = law.to_string();
            assert_eq!(ControllerId::from_name(&name).map(ControllerId::name), Some(&*name));
        }
    }

    #[test]
    fn former_names_of_laws_are_accepted() {
        assert_eq!("faithful".parse(), Ok(Law::Merzouki));
        assert_eq!("compensating".parse(), Ok(Law::BacklashInverse));
        assert!("lqr".parse::<Law>().is_err());
    }
}
