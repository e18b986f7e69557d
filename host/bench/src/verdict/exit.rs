//! Verdicts and exit codes.

use std::fmt;
use std::process::ExitCode;

use serde::{Deserialize, Serialize};

/// Result of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "UPPERCASE")]
pub enum Verdict {
    /// All expectations are met.
    Pass,
    /// An expectation is missed, or a metric isn't finite.
    Fail,
    /// Link or timing broke what the scenario allows.
    Invalid,
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Pass => "PASS",
            Self::Fail => "FAIL",
            Self::Invalid => "INVALID",
        })
    }
}

/// Exit codes of the tool, for scripts and CI.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Exit {
    /// The verdict is PASS, or the command judges nothing.
    Pass = 0,
    /// The verdict is FAIL.
    Fail = 1,
    /// Wrong command line or scenario; no run was made.
    UsageOrScenario = 2,
    /// The verdict is INVALID.
    Invalid = 3,
    /// Device or link failed; the run has no verdict.
    DeviceOrLink = 4,
    /// The hardware of a rig is absent; nothing was run.
    HardwareAbsent = 5,
}

impl From<Verdict> for Exit {
    fn from(verdict: Verdict) -> Self {
        match verdict {
            Verdict::Pass => Self::Pass,
            Verdict::Fail => Self::Fail,
            Verdict::Invalid => Self::Invalid,
        }
    }
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        Self::from(exit as u8)
    }
}
