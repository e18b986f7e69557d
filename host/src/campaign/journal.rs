//! What the journal of a campaign belongs to.

use serde::{Deserialize, Serialize};

use super::plan::Settings;
use crate::journal::JournalHeader;

/// The campaign that a journal belongs to.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Header {
    pub lashloop: String,
    /// SHA-256 of the program's file, which holds plant and drive.
    pub program_sha256: String,
    pub settings: Settings,
}

impl JournalHeader for Header {
    fn facts(&self) -> Vec<(&'static str, String)> {
        let Self { lashloop, program_sha256, settings } = self;
        let laws: Vec<_> = settings.laws.iter().map(ToString::to_string).collect();
        vec![
            ("version", lashloop.clone()),
            ("seed", settings.seed.to_string()),
            ("number of plants", settings.plants.to_string()),
            ("list of controllers", laws.join(",")),
            ("choice of sweeps", if settings.sweeps { "with" } else { "without" }.to_owned()),
            ("program's SHA-256", program_sha256.clone()),
        ]
    }
}

#[cfg(test)]
mod tests;
