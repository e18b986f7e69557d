//! What came of a run.

use std::fmt;

use lashloop_protocol::enums::FaultCode;
use lashloop_protocol::message::FaultReport;

use crate::fault::log::FaultRecord;
use crate::session::AtStep;
use crate::timing::TimingReport;
use crate::verdict::{Judgement, LinkCounts, Verdict};
use lashloop_plant::PlantError;
use lashloop_plant::metrics::Metrics;

/// How a run ended.
#[derive(Debug, Clone, PartialEq)]
pub enum End {
    /// After its full duration.
    Complete,
    /// The drive latched a fault.
    DriveFault(AtStep<FaultReport>),
    /// The drive started anew in the middle of the run.
    DriveRestarted,
    /// The plant could not be followed any further: its state left the range of numbers, above all.
    Diverged(PlantError),
    /// The user asked the bench to stop.
    Interrupted,
}

impl End {
    /// Whether the drive is still there, in the session that the run was made in.
    #[must_use]
    pub fn leaves_a_session(&self) -> bool {
        match self {
            Self::DriveFault(fault) => !matches!(fault.code, FaultCode::Panic | FaultCode::ProcessorFault),
            Self::DriveRestarted => false,
            Self::Complete | Self::Diverged(_) | Self::Interrupted => true,
        }
    }

    /// The verdict a run can't rise above because of its end. A watchdog that trips tells of the host or of the line,
    /// and an integration that can't go on of the plant, not of the controller.
    #[must_use]
    pub fn verdict(&self) -> Option<Verdict> {
        match self {
            Self::Complete => None,
            Self::DriveFault(fault) if fault.code == FaultCode::Watchdog => Some(Verdict::Invalid),
            Self::Diverged(PlantError::Chattering { .. } | PlantError::TooStiff { .. }) => {
                Some(Verdict::Invalid)
            }
            Self::DriveFault(_) | Self::Diverged(_) => Some(Verdict::Fail),
            Self::DriveRestarted | Self::Interrupted => Some(Verdict::Invalid),
        }
    }
}

impl fmt::Display for End {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Complete => write!(out, "complete"),
            Self::DriveRestarted => write!(
                out,
                "the drive started anew in the middle of the run; with link.on_loss = \"resume\" the bench would go on"
            ),
            Self::Interrupted => write!(out, "interrupted by the user"),
            Self::Diverged(error) => write!(out, "the plant can't be followed any further: {error}"),
            Self::DriveFault(fault) => {
                let AtStep { step, message: FaultReport { code, value, limit, detail, .. } } = fault;
                match code {
                    FaultCode::Panic => write!(out, "the firmware panicked, source line {detail}"),
                    FaultCode::ProcessorFault => {
                        write!(
                            out,
                            "the processor took a fault at {detail:#010x}, or an interrupt of that number"
                        )
                    }
                    _ => write!(
                        out,
                        "the drive latched {code:?} at sample {step} (value {value}, limit {limit})"
                    ),
                }
            }
        }
    }
}

/// A judged run.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// Verdict and reasons.
    pub judgement: Judgement,
    /// How it ended.
    pub end: End,
    /// What was measured.
    pub metrics: Metrics,
    /// What the link counted.
    pub link: LinkCounts,
    /// How the steps went in time.
    pub timing: TimingReport,
    /// The faults of the scenario that have been there, in its order.
    pub faults: Vec<FaultRecord>,
    /// Control steps made.
    pub steps: u64,
    /// Time of the plant.
    pub simulated_s: f64,
    /// Time on the wall, from the start of the controller to the last answer.
    pub wall_s: f64,
    /// Digest of the torque stream.
    pub torque_sha256: String,
    /// What the drive said in words.
    pub logs: Vec<String>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plant_that_cannot_be_followed_says_nothing_of_the_drive_unless_the_drive_drove_it_away() {
        let chattering = PlantError::Chattering { substep_s: 1e-3 };
        let too_stiff = PlantError::TooStiff { needed: 1e6, dt_s: 1e-3 };
        let away = PlantError::NotFinite { torque_nm: 1e300 };
        assert_eq!(End::Diverged(chattering).verdict(), Some(Verdict::Invalid));
        assert_eq!(End::Diverged(too_stiff).verdict(), Some(Verdict::Invalid));
        assert_eq!(End::Diverged(away).verdict(), Some(Verdict::Fail));
    }
}
