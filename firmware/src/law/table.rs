//! The tables of a set of laws, computed when the drive is compiled: parameters and signals of the drive and of all its
//! laws, each name once. [`laws!`](macro@crate::laws) calls this module; nothing else does.
//!
//! A declaration that the wire can't carry, or that contradicts another one of the same name, doesn't compile.

use lashloop_protocol::limits::MAX_LAWS;
pub use lashloop_protocol::limits::{MAX_PARAMETERS, MAX_SIGNALS};
use lashloop_protocol::text::{ChoiceName, LawName, ParameterName, SignalName, UnitName};

use super::control_law::ControlLaw;
use super::drive_parameters::DriveParameters;
use super::parameter::{Parameter, Range};
use super::parameter_error::ParameterError;
use super::parameter_group::{ParameterGroups, Words};
use super::signal::{Signal, Signals};
use text::{check_name, check_names, check_text, fail, same_text, same_texts};

pub use live::mark_live;

mod live;
mod text;

/// Most choices of a parameter: a choice is sent as one byte.
const CHOICES_MAX: usize = 256;

/// Entries without repeated names.
pub struct Collected<T, const MAX: usize> {
    entries: [T; MAX],
    /// Number of entries.
    pub len: usize,
}

impl<T: Copy, const MAX: usize> Collected<T, MAX> {
    /// The entries as an array of their number.
    #[must_use]
    pub const fn exact<const N: usize>(&self) -> [T; N] {
        let mut exact = [self.entries[0]; N];
        let mut at = 0;
        while at < N {
            exact[at] = self.entries[at];
            at += 1;
        }
        exact
    }
}

macro_rules! collected {
    ($item:ident, $max:ident, $empty:expr, $too_many:literal, $collect:ident, $map:ident) => {
        /// The drive's own entries, then those of each law, each name once, with the laws that have it.
        #[must_use]
        pub const fn $collect(own: &[&[$item]], laws: &[&[&[$item]]]) -> Collected<$item, $max> {
            let mut all = Collected { entries: [$empty; $max], len: 0 };
            all.add_groups(own, every_law(laws.len()));
            let mut law = 0;
            while law < laws.len() {
                all.add_groups(laws[law], 1 << law);
                law += 1;
            }
            all
        }

        impl Collected<$item, $max> {
            const fn add_groups(&mut self, groups: &[&[$item]], laws: u16) {
                let mut group = 0;
                while group < groups.len() {
                    let mut at = 0;
                    while at < groups[group].len() {
                        self.add(groups[group][at], laws);
                        at += 1;
                    }
                    group += 1;
                }
            }

            const fn add(&mut self, item: $item, laws: u16) {
                let (known, _) = self.entries.split_at(self.len);
                let mut at = 0;
                while at < known.len() && !same_text(known[at].name, item.name) {
                    at += 1;
                }
                if at == self.len {
                    item.check();
                    if self.len == $max {
                        fail(item.name, $too_many);
                    }
                    self.entries[at] = item;
                    self.len += 1;
                } else {
                    item.check_repeated(&self.entries[at], laws);
                }
                self.entries[at].laws |= laws;
            }
        }

        /// For each entry of the groups, one after the other, its index in the table.
        #[must_use]
        pub const fn $map<const N: usize>(table: &[$item], groups: &[&[$item]]) -> [u8; N] {
            let mut map = [0; N];
            let (mut group, mut next) = (0, 0);
            while group < groups.len() {
                let mut at = 0;
                while at < groups[group].len() {
                    let mut index = 0;
                    while !same_text(table[index].name, groups[group][at].name) {
                        index += 1;
                    }
                    map[next] = index as u8;
                    (at, next) = (at + 1, next + 1);
                }
                group += 1;
            }
            map
        }
    };
}

collected!(
    Parameter,
    MAX_PARAMETERS,
    Parameter::new("", "", Range::U32 { default: 0, min: 0, max: 0 }),
    "is one parameter too many: a drive has at most 240",
    collect_parameters,
    map_parameters
);
collected!(
    Signal,
    MAX_SIGNALS,
    Signal::new("", ""),
    "is one signal too many: a drive has at most 32",
    collect_signals,
    map_signals
);

impl Parameter {
    const fn check(&self) {
        check_name(
            "a parameter",
            self.name,
            ParameterName::CAPACITY,
            "is longer than the 27 bytes of a parameter's name",
        );
        check_text(self.unit, UnitName::CAPACITY, "is longer than the 10 bytes of a unit");
        let is_consistent = match self.range {
            Range::U32 { default, min, max } => min <= default && default <= max,
            Range::F32 { default, min, max } => {
                min <= default && default <= max && min.is_finite() && max.is_finite()
            }
            Range::Choice { default, names } => {
                check_names(
                    "a choice",
                    names,
                    ChoiceName::CAPACITY,
                    "is longer than the 28 bytes of a choice",
                    "is the name of two choices of one parameter",
                );
                names.len() <= CHOICES_MAX && (default as usize) < names.len()
            }
        };
        if !is_consistent {
            fail(self.name, "has a default outside its range, a range without an end, or too many choices");
        }
    }

    /// One name is one parameter, so all its declarations must agree.
    const fn check_repeated(&self, other: &Self, _laws: u16) {
        let same_range = match (self.range, other.range) {
            (
                Range::U32 { default, min, max },
                Range::U32 { default: other_default, min: other_min, max: other_max },
            ) => default == other_default && min == other_min && max == other_max,
            (
                Range::F32 { default, min, max },
                Range::F32 { default: other_default, min: other_min, max: other_max },
            ) => default == other_default && min == other_min && max == other_max,
            (
                Range::Choice { default, names },
                Range::Choice { default: other_default, names: other_names },
            ) => default == other_default && same_texts(names, other_names),
            _ => false,
        };
        if !same_range || !same_text(self.unit, other.unit) {
            fail(self.name, "is declared twice, with different units, defaults or ranges");
        }
    }
}

impl Signal {
    const fn check(&self) {
        check_name(
            "a signal",
            self.name,
            SignalName::CAPACITY,
            "is longer than the 32 bytes of a signal's name",
        );
        check_text(self.unit, UnitName::CAPACITY, "is longer than the 10 bytes of a unit");
    }

    /// Two laws may have a signal of one name, because one of them runs at a time.
    const fn check_repeated(&self, other: &Self, laws: u16) {
        if !same_text(self.unit, other.unit) {
            fail(self.name, "is declared twice, with different units");
        }
        if other.laws & laws != 0 {
            fail(self.name, "is a signal of the drive itself, or twice a signal of one law");
        }
    }
}

/// Checks the names of the laws and returns the drive's own parameter that selects one of them.
#[must_use]
pub const fn controller(names: &'static [&'static str]) -> Parameter {
    check_names(
        "a law",
        names,
        LawName::CAPACITY,
        "is longer than the 28 bytes of a law's name",
        "is the name of two laws",
    );
    Parameter::new("controller", "", Range::Choice { default: 0, names })
}

/// Mask of all laws.
const fn every_law(count: usize) -> u16 {
    assert!(count <= MAX_LAWS, "a drive has at most 16 laws");
    (u16::MAX as u32 >> (MAX_LAWS - count)) as u16
}

/// Number of entries in all groups.
#[must_use]
pub const fn total<T>(groups: &[&[T]]) -> usize {
    let (mut total, mut group) = (0, 0);
    while group < groups.len() {
        total += groups[group].len();
        group += 1;
    }
    total
}

/// Checks that parameters may follow those of a table.
pub const fn check_appended(table: &[Parameter], appended: &[Parameter]) {
    let mut at = 0;
    while at < appended.len() {
        appended[at].check();
        let mut earlier = 0;
        while earlier < table.len() {
            if same_text(table[earlier].name, appended[at].name) {
                fail(appended[at].name, "is a parameter of bench mode, and one of a law");
            }
            earlier += 1;
        }
        if table.len() + at == MAX_PARAMETERS {
            fail(appended[at].name, "is one parameter too many: a drive has at most 240");
        }
        at += 1;
    }
}

/// The words of the defaults.
#[must_use]
pub const fn defaults<const N: usize>(table: &[Parameter]) -> [u32; N] {
    let mut words = [0; N];
    let mut at = 0;
    while at < N {
        words[at] = table[at].range.default_word();
        at += 1;
    }
    words
}

/// A law in its initial state. `map` has the index of each of its parameters in the drive's table.
///
/// # Errors
/// If the parameters, each in its range, don't go together.
pub fn build<L: ControlLaw>(map: &[u8], words: &[u32], drive: &DriveParameters) -> Result<L, ParameterError> {
    L::new(L::Parameters::read(&mut Words::new(words, map)), drive)
}

/// Passes the parameters to a law after the change of a live one. `map` is as in [`build`].
///
/// # Errors
/// If the new value doesn't go with the others. The law is then as before.
pub fn update<L: ControlLaw>(law: &mut L, map: &[u8], words: &[u32]) -> Result<(), ParameterError> {
    // A law without live parameters costs the image nothing.
    if L::LIVE.is_empty() {
        return Ok(());
    }
    law.update(&L::Parameters::read(&mut Words::new(words, map)))
}

/// The error for a law that doesn't exist; the range of `controller` excludes it.
#[must_use]
pub const fn no_law(law: u32, names: &[&str]) -> ParameterError {
    ParameterError {
        name: "controller",
        value: law as f32,
        max: names.len() as f32 - 1.0,
        given_by: "the number of laws",
    }
}

/// Writes the signals of a law to their places. `map` has the index of each of them in the drive's table.
pub fn scatter<S: Signals>(signals: &S, map: &[u8], values: &mut [f32; MAX_SIGNALS]) {
    let mut own = [0.0; MAX_SIGNALS];
    signals.write(&mut own);
    for (index, value) in map.iter().zip(own) {
        if let Some(place) = values.get_mut(usize::from(*index)) {
            *place = value;
        }
    }
}

#[cfg(test)]
mod tests;
