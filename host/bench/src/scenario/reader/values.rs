//! Values of keys: numbers, texts and choices.

use std::fmt::Display;
use std::ops::RangeInclusive;

use super::section::Section;
use crate::scenario::key::KeyKind;
use crate::scenario::key_error::KeyError;
use crate::scenario::origin::Origin;
use crate::scenario::range::NumberRange;
use crate::scenario::spelling::{decimal_point, either, with_unit};
use crate::scenario::tree::{Node, Value};

/// Up to here a fraction holds every whole number.
const EXACT: f64 = (1_u64 << 53) as f64;

/// A value of a list whose values are of any kind.
#[derive(Debug, Clone, PartialEq)]
pub enum Scalar {
    /// A number, exact up to 2^53 if it is whole.
    Number(f64),
    /// `true` or `false`.
    Boolean(bool),
    /// A text.
    Text(String),
}

impl<'a> Section<'a> {
    /// A number, required unless it has a default.
    pub fn number(
        &mut self,
        key: &'static str,
        default: impl Into<Option<f64>>,
        range: impl Into<NumberRange>,
    ) -> f64 {
        let (default, range, unit) = (default.into(), range.into(), self.unit_of(key));
        let allowed = range.describe(unit);
        let required = default.is_none().then(|| format!("a number {allowed}"));
        let number = match self.look_up(key, unit, KeyKind::Number { range, default }, required) {
            Some(node) => self.check_number(key, node, range, &allowed),
            None => default.unwrap_or(f64::NAN),
        };
        self.in_force(key, number)
    }

    /// An optional number in `unit`.
    pub fn optional_number(
        &mut self,
        key: &'static str,
        unit: &'static str,
        range: impl Into<NumberRange>,
    ) -> Option<f64> {
        let range = range.into();
        let node = self.look_up(key, unit, KeyKind::Number { range, default: None }, None)?;
        let number = self.check_number(key, node, range, &range.describe(unit));
        Some(self.in_force(key, number))
    }

    fn check_number(&self, key: &str, node: &Node, range: NumberRange, allowed: &str) -> f64 {
        let number = match node.value {
            // Exact up to 2^53, far beyond every range here.
            Value::Integer(number) => number as f64,
            Value::Float(number) => number,
            _ => {
                self.not_a_number(key, node, format!("a number {allowed}"));
                return f64::NAN;
            }
        };
        if range.contains(number) {
            return number;
        }
        self.error(
            key,
            node,
            KeyError::OutOfRange { found: node.value.to_string(), allowed: allowed.to_owned() },
        );
        f64::NAN
    }

    /// A whole number, required unless it has a default.
    pub fn integer<T>(
        &mut self,
        key: &'static str,
        default: impl Into<Option<T>>,
        range: RangeInclusive<T>,
    ) -> T
    where
        T: Copy + Display + PartialOrd + TryFrom<i64> + Into<i128>,
    {
        let (default, unit) = (default.into(), self.unit_of(key));
        let allowed = describe(&range, unit);
        let required = default.is_none().then(|| format!("a whole number {allowed}"));
        let stand_in = default.unwrap_or(*range.start());
        let Some(node) = self.look_up(key, unit, whole_number(&range, default), required) else {
            return stand_in;
        };
        self.check_integer(key, node, &range, allowed).unwrap_or(stand_in)
    }

    /// An optional whole number.
    pub fn optional_integer<T>(&mut self, key: &'static str, range: RangeInclusive<T>) -> Option<T>
    where
        T: Copy + Display + PartialOrd + TryFrom<i64> + Into<i128>,
    {
        let unit = self.unit_of(key);
        let node = self.look_up(key, unit, whole_number(&range, None), None)?;
        let allowed = describe(&range, unit);
        self.check_integer(key, node, &range, allowed)
    }

    fn check_integer<T>(
        &self,
        key: &str,
        node: &Node,
        range: &RangeInclusive<T>,
        allowed: String,
    ) -> Option<T>
    where
        T: PartialOrd + TryFrom<i64>,
    {
        let found = match node.value {
            Value::Integer(found) => Some(found),
            // 1e3 is a whole number. A larger one may have been rounded by the reader of the file.
            Value::Float(found) if found.fract() == 0.0 => (found.abs() <= EXACT).then_some(found as i64),
            _ => {
                self.not_a_number(key, node, format!("a whole number {allowed}"));
                return None;
            }
        };
        let number = found.and_then(|found| T::try_from(found).ok()).filter(|number| range.contains(number));
        if number.is_none() {
            self.error(key, node, KeyError::OutOfRange { found: node.value.to_string(), allowed });
        }
        number
    }

    /// A value that is no number, for instance because of a decimal comma.
    fn not_a_number(&self, key: &str, node: &Node, allowed: String) {
        let written = match &node.value {
            Value::Text(text) => decimal_point(text),
            _ => None,
        };
        match written {
            Some(written) => self.reject(key, format!("has a decimal comma; write {written}")),
            None => self.wrong_type(key, node, allowed),
        }
    }

    /// A text; `None` if absent or faulty. `purpose` describes a required one.
    pub fn text(&mut self, key: &'static str, purpose: Option<&str>) -> Option<&'a str> {
        let node = self.look_up(key, "", KeyKind::Text, purpose.map(str::to_owned))?;
        if let Value::Text(text) = &node.value {
            return Some(text);
        }
        self.wrong_type(key, node, purpose.unwrap_or("a text in quotes").to_owned());
        None
    }

    /// A list of texts; `None` if absent or faulty. `purpose` describes a required one.
    pub fn texts(&mut self, key: &'static str, purpose: Option<&str>) -> Option<Vec<&'a str>> {
        let node = self.look_up(key, "", KeyKind::Texts, purpose.map(str::to_owned))?;
        let texts = match &node.value {
            Value::Array(items) => items.iter().map(Node::text).collect(),
            _ => None,
        };
        if texts.is_none() {
            self.wrong_type(key, node, purpose.unwrap_or("a list of texts in quotes").to_owned());
        }
        texts
    }

    /// An optional list of numbers, booleans or texts. `allowed` describes it. `None` if absent or faulty.
    pub(in crate::scenario) fn optional_values(
        &mut self,
        key: &'static str,
        allowed: &str,
    ) -> Option<&'a [Node]> {
        let node = self.look_up(key, "", KeyKind::Values, None)?;
        let is_scalar = |item: &Node| {
            matches!(item.value, Value::Text(_) | Value::Integer(_) | Value::Float(_) | Value::Boolean(_))
        };
        match &node.value {
            Value::Array(items) if !items.is_empty() && items.iter().all(is_scalar) => Some(items),
            _ => {
                self.wrong_type(key, node, allowed.to_owned());
                None
            }
        }
    }

    /// An optional list of numbers, booleans or texts, without their places. `allowed` describes it.
    pub fn optional_scalars(&mut self, key: &'static str, allowed: &str) -> Option<Vec<Scalar>> {
        let scalar = |node: &Node| match &node.value {
            Value::Integer(number) => Some(Scalar::Number(*number as f64)),
            Value::Float(number) => Some(Scalar::Number(*number)),
            Value::Boolean(boolean) => Some(Scalar::Boolean(*boolean)),
            Value::Text(text) => Some(Scalar::Text(text.clone())),
            Value::Date(_) | Value::Array(_) | Value::Table(_) => None,
        };
        self.optional_values(key, allowed)?.iter().map(scalar).collect()
    }

    /// An optional list of texts, each with its place. `allowed` describes it. `None` if absent or faulty.
    pub(in crate::scenario) fn optional_texts(
        &mut self,
        key: &'static str,
        allowed: &str,
    ) -> Option<Vec<(&'a str, &'a Origin)>> {
        let node = self.look_up(key, "", KeyKind::Texts, None)?;
        let Value::Array(items) = &node.value else {
            self.wrong_type(key, node, allowed.to_owned());
            return None;
        };
        let mut texts = Vec::new();
        for (index, item) in items.iter().enumerate() {
            match &item.value {
                Value::Text(text) => texts.push((&**text, &item.origin)),
                _ => self.wrong_type(&format!("{key}.{index}"), item, "a text in quotes".to_owned()),
            }
        }
        Some(texts)
    }

    /// One of several names, required unless it has a default. `None` if absent or faulty.
    pub fn choice<T: Copy + PartialEq>(
        &mut self,
        key: &'static str,
        default: impl Into<Option<T>>,
        choices: &[(&'static str, T)],
    ) -> Option<T> {
        let default = default.into();
        self.read_choice(key, default, default.is_none(), choices)
    }

    /// One of several names, or none. `None` if absent or faulty.
    pub fn optional_choice<T: Copy + PartialEq>(
        &mut self,
        key: &'static str,
        choices: &[(&'static str, T)],
    ) -> Option<T> {
        self.read_choice(key, None, false, choices)
    }

    fn read_choice<T: Copy + PartialEq>(
        &mut self,
        key: &'static str,
        default: Option<T>,
        is_required: bool,
        choices: &[(&'static str, T)],
    ) -> Option<T> {
        let allowed = either(choices.iter().map(|(word, _)| *word));
        let kind = KeyKind::Choice {
            choices: self.documented(choices.iter().map(|(word, _)| *word)),
            default: default
                .and_then(|default| choices.iter().find(|(_, choice)| *choice == default))
                .map(|(word, _)| *word),
        };
        let Some(node) = self.look_up(key, "", kind, is_required.then(|| allowed.clone())) else {
            return default;
        };
        let Value::Text(found) = &node.value else {
            self.wrong_type(key, node, allowed);
            return None;
        };
        let choice = find(choices, found);
        if choice.is_none() {
            self.error(key, node, KeyError::NotAChoice { found: node.value.to_string(), allowed });
        }
        choice
    }

    /// Several of these names, each with the origin of its entry; a single one may stand without a list.
    pub(in crate::scenario) fn choices<T: Copy>(
        &mut self,
        key: &'static str,
        choices: &[(&'static str, T)],
    ) -> Vec<(T, Node)> {
        let kind = KeyKind::Choices(self.documented(choices.iter().map(|(word, _)| *word)));
        let Some(node) = self.look_up(key, "", kind, None) else {
            return Vec::new();
        };
        let items = match &node.value {
            Value::Array(items) => items.as_slice(),
            _ => std::slice::from_ref(node),
        };
        let mut chosen = Vec::new();
        for item in items {
            let allowed = either(choices.iter().map(|(word, _)| *word));
            match item.text().map(|text| find(choices, text)) {
                Some(Some(choice)) => chosen.push((choice, item.clone())),
                Some(None) => {
                    self.error(key, item, KeyError::NotAChoice { found: item.value.to_string(), allowed });
                }
                None => self.wrong_type(key, item, allowed),
            }
        }
        chosen
    }
}

fn find<T: Copy>(choices: &[(&'static str, T)], found: &str) -> Option<T> {
    choices.iter().find(|(word, _)| *word == found).map(|(_, choice)| *choice)
}

fn whole_number<T: Copy + Into<i128>>(range: &RangeInclusive<T>, default: Option<T>) -> KeyKind {
    KeyKind::WholeNumber {
        low: (*range.start()).into(),
        high: (*range.end()).into(),
        default: default.map(Into::into),
    }
}

fn describe<T: Display>(range: &RangeInclusive<T>, unit: &str) -> String {
    with_unit(format!(">= {} and <= {}", range.start(), range.end()), unit)
}
