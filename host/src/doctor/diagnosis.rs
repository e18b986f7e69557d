//! One property of the line and its diagnosis.

use std::fmt;

/// One thing that was looked at.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Diagnosis {
    /// What was looked at.
    pub subject: &'static str,
    /// How it is.
    pub health: Health,
    /// What was seen, and what to do where something is to be done.
    pub text: String,
}

/// How something is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Health {
    /// As it should be.
    Fine,
    /// There is no such thing on this terminal.
    NotApplicable,
    /// To be mended.
    Wrong,
}

impl Diagnosis {
    pub(super) fn wrong(subject: &'static str, text: impl Into<String>) -> Self {
        Self { subject, health: Health::Wrong, text: text.into() }
    }

    pub(super) fn fine(subject: &'static str, text: impl Into<String>) -> Self {
        Self { subject, health: Health::Fine, text: text.into() }
    }

    pub(super) fn not_applicable(subject: &'static str, text: impl Into<String>) -> Self {
        Self { subject, health: Health::NotApplicable, text: text.into() }
    }

    /// Whether it is to be mended.
    #[must_use]
    pub fn is_wrong(&self) -> bool {
        self.health == Health::Wrong
    }
}

impl fmt::Display for Diagnosis {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let health = match self.health {
            Health::Fine => "ok",
            Health::NotApplicable => "n/a",
            Health::Wrong => "WRONG",
        };
        write!(out, "{health:<6} {:<14} {}", self.subject, self.text)
    }
}
