//! Values of keys: numbers, texts and choices.

use std::fmt::Display;
use std::ops::RangeInclusive;

use super::section::Section;
use crate::scenario::key_error::KeyError;
use crate::scenario::origin::Origin;
use crate::scenario::range::NumberRange;
use crate::scenario::spelling::{either, with_unit};
use crate::scenario::tree::{Node, Value};
use crate::scenario::unit;

impl<'a> Section<'a> {
    /// A number, required unless it has a default.
    pub(in crate::scenario) fn number(
        &mut self,
        key: &'static str,
        default: impl Into<Option<f64>>,
        range: impl Into<NumberRange>,
    ) -> f64 {
        let (default, range, unit) = (default.into(), range.into(), unit::of(key));
        let allowed = range.describe(unit);
        let required = default.is_none().then(|| format!("a number {allowed}"));
        let Some(node) = self.look_up(key, unit, required) else {
            return default.unwrap_or(f64::NAN);
        };
        self.check_number(key, node, range, &allowed)
    }

    /// An optional number in `unit`.
    pub(in crate::scenario) fn optional_number(
        &mut self,
        key: &'static str,
        unit: &'static str,
        range: impl Into<NumberRange>,
    ) -> Option<f64> {
        let range = range.into();
        let node = self.look_up(key, unit, None)?;
        Some(self.check_number(key, node, range, &range.describe(unit)))
    }

    fn check_number(&self, key: &str, node: &Node, range: NumberRange, allowed: &str) -> f64 {
        let number = match node.value {
            // Exact up to 2^53, far beyond every range here.
            Value::Integer(number) => number as f64,
            Value::Float(number) => number,
            _ => {
                self.wrong_type(key, node, format!("a number {allowed}"));
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
    pub(in crate::scenario) fn integer<T>(
        &mut self,
        key: &'static str,
        default: impl Into<Option<T>>,
        range: RangeInclusive<T>,
    ) -> T
    where
        T: Copy + Display + PartialOrd + TryFrom<i64>,
    {
        let (default, unit) = (default.into(), unit::of(key));
        let allowed = describe(&range, unit);
        let required = default.is_none().then(|| format!("a whole number {allowed}"));
        let stand_in = default.unwrap_or(*range.start());
        let Some(node) = self.look_up(key, unit, required) else {
            return stand_in;
        };
        self.check_integer(key, node, &range, allowed).unwrap_or(stand_in)
    }

    /// An optional whole number.
    pub(in crate::scenario) fn optional_integer<T>(
        &mut self,
        key: &'static str,
        range: RangeInclusive<T>,
    ) -> Option<T>
    where
        T: Copy + Display + PartialOrd + TryFrom<i64>,
    {
        let unit = unit::of(key);
        let node = self.look_up(key, unit, None)?;
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
        let Value::Integer(found) = node.value else {
            self.wrong_type(key, node, format!("a whole number {allowed}"));
            return None;
        };
        let number = T::try_from(found).ok().filter(|number| range.contains(number));
        if number.is_none() {
            self.error(key, node, KeyError::OutOfRange { found: found.to_string(), allowed });
        }
        number
    }

    /// A text; `None` if absent or faulty. `purpose` describes a required one.
    pub(in crate::scenario) fn text(&mut self, key: &'static str, purpose: Option<&str>) -> Option<&'a str> {
        let node = self.look_up(key, "", purpose.map(str::to_owned))?;
        if let Value::Text(text) = &node.value {
            return Some(text);
        }
        self.wrong_type(key, node, purpose.unwrap_or("a text in quotes").to_owned());
        None
    }

    /// An optional list of texts, each with its place. `allowed` describes it. `None` if absent or faulty.
    pub(in crate::scenario) fn optional_texts(
        &mut self,
        key: &'static str,
        allowed: &str,
    ) -> Option<Vec<(&'a str, &'a Origin)>> {
        let node = self.look_up(key, "", None)?;
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
    pub(in crate::scenario) fn choice<T: Copy>(
        &mut self,
        key: &'static str,
        default: impl Into<Option<T>>,
        choices: &[(&'static str, T)],
    ) -> Option<T> {
        let default = default.into();
        let allowed = either(choices.iter().map(|(word, _)| *word));
        let Some(node) = self.look_up(key, "", default.is_none().then(|| allowed.clone())) else {
            return default;
        };
        let Value::Text(found) = &node.value else {
            self.wrong_type(key, node, allowed);
            return None;
        };
        let choice = choices.iter().find(|(word, _)| word == found).map(|(_, choice)| *choice);
        if choice.is_none() {
            self.error(key, node, KeyError::NotAChoice { found: node.value.to_string(), allowed });
        }
        choice
    }
}

fn describe<T: Display>(range: &RangeInclusive<T>, unit: &str) -> String {
    with_unit(format!(">= {} and <= {}", range.start(), range.end()), unit)
}
