//! One property of the line and its condition.

use std::fmt;

use serde::Serialize;

#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Finding {
    pub subject: &'static str,
    pub health: Health,
    /// The observation, and the remedy if one is needed.
    pub text: String,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Health {
    Fine,
    /// The terminal has no such property.
    NotApplicable,
    /// Needs a remedy.
    Wrong,
}

impl Finding {
    pub(crate) fn wrong(subject: &'static str, text: impl Into<String>) -> Self {
        Self { subject, health: Health::Wrong, text: text.into() }
    }

    pub(crate) fn fine(subject: &'static str, text: impl Into<String>) -> Self {
        Self { subject, health: Health::Fine, text: text.into() }
    }

    pub(crate) fn not_applicable(subject: &'static str, text: impl Into<String>) -> Self {
        Self { subject, health: Health::NotApplicable, text: text.into() }
    }

    #[must_use]
    pub fn is_wrong(&self) -> bool {
        self.health == Health::Wrong
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let health = match self.health {
            Health::Fine => "ok",
            Health::NotApplicable => "n/a",
            Health::Wrong => "WRONG",
        };
        write!(out, "{health:<6} {:<14} {}", self.subject, self.text)
    }
}
