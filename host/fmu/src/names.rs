//! Variables by name, with what they must be.

use crate::error::FmuError;
use crate::variable::{Kind, Variable};

/// Similarity from which a name is suggested.
const SIMILAR: f64 = 0.7;
/// Names in a suggestion.
const SUGGESTIONS: usize = 3;

/// What a key needs of its variable.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Role {
    /// A torque that can be set.
    Torque,
    /// A position.
    Position,
    /// Any number.
    Signal,
    /// A start value.
    Start,
}

impl Role {
    const fn needs(self) -> &'static str {
        match self {
            Self::Torque => "an input of type Real or Float64 in N m",
            Self::Position => "a Real or Float64 in rad",
            Self::Signal => "a number that isn't an array",
            Self::Start => "a number, a boolean or a text that isn't an array",
        }
    }

    /// Whether a variable fits. One without a unit does.
    pub(crate) fn takes(self, variable: &Variable) -> bool {
        let unit = &*variable.unit;
        !variable.is_array
            && match self {
                Self::Torque => {
                    variable.kind.is_float()
                        && variable.causality == "input"
                        && matches!(unit, "" | "N.m" | "N m" | "N*m" | "Nm")
                }
                Self::Position => variable.kind.is_float() && matches!(unit, "" | "rad"),
                Self::Signal => variable.kind.is_number(),
                Self::Start => variable.kind.is_number() || variable.kind == Kind::Text,
            }
    }
}

/// The variable that `plant.KEY` names.
pub(crate) fn find<'a>(
    variables: &'a [Variable],
    name: &str,
    key: &str,
    role: Role,
) -> Result<&'a Variable, FmuError> {
    let (name_of, key) = (name.to_owned(), key.to_owned());
    let found = variables.iter().find(|variable| variable.name == name);
    let Some(variable) = found else {
        let near = near(variables, name, role);
        return Err(FmuError::NoVariable { name: name_of, key, near });
    };
    if !role.takes(variable) {
        let is = variable.describe();
        return Err(FmuError::Unfit { name: name_of, key, is, needs: role.needs() });
    }
    Ok(variable)
}

/// `; similar ones are "a" and "b"`, of those that fit.
fn near(variables: &[Variable], name: &str, role: Role) -> String {
    let lower = name.to_lowercase();
    let similarity = |it: &&Variable| strsim::jaro_winkler(&it.name.to_lowercase(), &lower);
    let mut near: Vec<_> = variables
        .iter()
        .filter(|variable| role.takes(variable))
        .map(|variable| (similarity(&variable), &variable.name))
        .filter(|(similarity, _)| *similarity >= SIMILAR)
        .collect();
    near.sort_by(|(a, _), (b, _)| b.total_cmp(a));
    let names: Vec<_> = near.iter().take(SUGGESTIONS).map(|(_, name)| format!("{name:?}")).collect();
    if names.is_empty() {
        return "; `lashloop fmu show` lists what it has".to_owned();
    }
    format!("; it has {}", names.join(", "))
}
