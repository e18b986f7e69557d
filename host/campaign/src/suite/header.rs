//! What the journal of a suite belongs to.

use serde::{Deserialize, Serialize};

use crate::journal::JournalHeader;

/// The suite that a journal belongs to. The scenarios are not part of it: a result counts if its case is unchanged.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Header {
    pub lashloop: String,
    /// SHA-256 of the program's file, which holds plant and drive.
    pub program_sha256: String,
    pub device: String,
    pub clock: String,
}

impl JournalHeader for Header {
    fn facts(&self) -> Vec<(&'static str, String)> {
        let Self { lashloop, program_sha256, device, clock } = self;
        vec![
            ("version", lashloop.clone()),
            ("device", device.clone()),
            ("clock", clock.clone()),
            ("program's SHA-256", program_sha256.clone()),
        ]
    }
}
