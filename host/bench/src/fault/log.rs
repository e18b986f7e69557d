//! The log of injected faults.

use std::borrow::Cow;

use serde::{Deserialize, Serialize};

/// A fault that was injected.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct FaultRecord {
    /// Name of its kind.
    pub kind: Cow<'static, str>,
    /// The step in which it began.
    pub step: u32,
    /// The first step after it; `None` if it lasted to the end. A cut and a hang last in the link's time.
    pub until_step: Option<u32>,
    /// Frames hit, by a fault of the link.
    pub frames: Option<u64>,
}
