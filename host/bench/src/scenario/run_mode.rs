//! `run.mode`: where the samples of a run come from, and where its torques go.

use serde::{Deserialize, Serialize};

use super::key::Choice;
use super::reader::Section;

/// Where the samples of a run come from, and where its torques go.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum RunMode {
    /// The bench simulates the plant: samples to the drive, torques from it.
    #[default]
    Hil,
    /// The drive reads its own encoders and commands its power stage; the bench sends references and judges the reports.
    Bench,
}

impl RunMode {
    /// Whether the run is in HIL mode.
    #[must_use]
    pub fn is_hil(&self) -> bool {
        *self == Self::Hil
    }
}

pub(super) fn read(run: &mut Section<'_>, key: &'static str) -> RunMode {
    let choice = |name, doc| Choice { name, doc };
    let meanings = vec![
        choice("hil", "the bench simulates the plant and exchanges samples for torques"),
        choice("bench", "the drive reads its own encoders and commands its power stage"),
    ];
    let choices = [("hil", RunMode::Hil), ("bench", RunMode::Bench)];
    run.choice_docs(meanings).choice(key, RunMode::Hil, &choices).unwrap_or_default()
}
