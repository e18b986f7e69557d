//! `run.mode`: where the samples of a run come from, and where its torques go.

use serde::Deserialize;

use crate::settings;

settings! {
    /// Where the samples of a run come from, and where its torques go.
    #[derive(Default, Deserialize)]
    #[serde(rename_all = "lowercase")]
    pub enum RunMode {
        /// the bench simulates the plant and exchanges samples for torques
        default "hil" => Hil,
        /// the drive reads its own encoders and commands its power stage
        "bench" => Bench,
    }
}

impl RunMode {
    /// Whether the run is in HIL mode.
    #[must_use]
    pub fn is_hil(&self) -> bool {
        *self == Self::Hil
    }
}
