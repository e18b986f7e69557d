//! How far two values may be apart.

use std::str::FromStr;

use lashloop_session::names::UnknownName;
use serde::Serialize;

/// A largest difference.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Tolerance {
    /// In the unit of the values.
    Absolute(f64),
    /// A fraction of the value in the first record; of a signal, of its largest amount there.
    Relative(f64),
}

impl Tolerance {
    /// The tolerance in the unit of values of this amount.
    #[must_use]
    pub fn at(self, amount: f64) -> f64 {
        match self {
            Self::Absolute(limit) => limit,
            Self::Relative(fraction) => fraction * amount,
        }
    }
}

/// `NAME=VALUE` in the unit of NAME, `NAME=PERCENT%`, or `PERCENT%` for all other names.
#[derive(Debug, Clone, PartialEq)]
pub struct ToleranceOf {
    name: Option<String>,
    tolerance: Tolerance,
}

impl FromStr for Tolerance {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let percent = text.trim().strip_suffix('%');
        let number = percent.unwrap_or(text).trim();
        let number: f64 = number.parse().map_err(|_| format!("{text:?} isn't a number"))?;
        if !(number.is_finite() && number >= 0.0) {
            return Err(format!("a tolerance is {number}; it must be 0 or more"));
        }
        Ok(if percent.is_some() { Self::Relative(number / 100.0) } else { Self::Absolute(number) })
    }
}

impl FromStr for ToleranceOf {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let Some((name, value)) = text.split_once('=') else {
            return match text.parse()? {
                tolerance @ Tolerance::Relative(_) => Ok(Self { name: None, tolerance }),
                Tolerance::Absolute(_) => Err(format!(
                    "{text:?} has no name, and units differ from name to name; write NAME={text}, or a percentage for all"
                )),
            };
        };
        Ok(Self { name: Some(name.trim().to_owned()), tolerance: value.parse()? })
    }
}

/// The tolerances of a comparison. Without one, values must be equal bit for bit.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Tolerances(pub Vec<ToleranceOf>);

impl Tolerances {
    /// The tolerance of this signal or metric; the last one given counts.
    #[must_use]
    pub fn of(&self, name: &str) -> Option<Tolerance> {
        let latest = |wanted: Option<&str>| self.0.iter().rev().find(|it| it.name.as_deref() == wanted);
        latest(Some(name)).or_else(|| latest(None)).map(|it| it.tolerance)
    }

    /// # Errors
    /// A tolerance has a name that is none of `known`.
    pub(super) fn check_names(&self, known: &[&str]) -> Result<(), UnknownName> {
        let names = self.0.iter().filter_map(|it| it.name.as_deref());
        match names.into_iter().find(|name| !known.contains(name)) {
            Some(name) => {
                Err(UnknownName::new("the comparison", "signal or metric", name, known.iter().copied()))
            }
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tolerances(texts: &[&str]) -> Tolerances {
        Tolerances(texts.iter().map(|text| text.parse().expect("a tolerance")).collect())
    }

    #[test]
    fn a_named_tolerance_precedes_the_one_for_all() {
        let tolerances = tolerances(&["torque_nm=0.5", "2 %", "torque_nm=1%"]);
        assert_eq!(tolerances.of("torque_nm"), Some(Tolerance::Relative(0.01)));
        assert_eq!(tolerances.of("load_position_rad"), Some(Tolerance::Relative(0.02)));
        assert_eq!(Tolerances::default().of("torque_nm"), None);
        assert_eq!(Tolerance::Relative(0.02).at(50.0), 1.0);
        assert_eq!(Tolerance::Absolute(0.5).at(50.0), 0.5);
    }

    #[test]
    fn a_number_without_a_name_is_refused_because_units_differ() {
        for (text, part) in [
            ("0.1", "write NAME=0.1"),
            ("torque_nm=much", "\"much\" isn't a number"),
            ("torque_nm=-1", "0 or more"),
            ("NaN%", "0 or more"),
        ] {
            let error = text.parse::<ToleranceOf>().expect_err(text);
            assert!(error.contains(part), "{text}: {error}");
        }
    }

    #[test]
    fn a_tolerance_for_no_signal_is_an_error() {
        let error =
            tolerances(&["torque=1"]).check_names(&["torque_nm", "hunting_rad"]).expect_err("no such name");
        assert_eq!(error.nearest.as_deref(), Some("torque_nm"));
        assert!(tolerances(&["1%", "hunting_rad=1"]).check_names(&["torque_nm", "hunting_rad"]).is_ok());
    }
}
