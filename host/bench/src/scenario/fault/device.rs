//! Faults of the drive itself.

use serde::Serialize;

use crate::settings;

settings! {
    /// Faults of the drive itself.
    #[derive(Debug, Clone, Copy, PartialEq, Serialize)]
    #[serde(tag = "kind")]
    pub enum DeviceFault {
        /// The drive restarts, as after a short loss of power.
        "device-reset" => Reset {},
        /// The drive is suspended, and resumes when the fault ends.
        "device-hang" => Hang {},
    }
}
