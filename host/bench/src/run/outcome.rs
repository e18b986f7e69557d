//! The end of a run and its results.

use std::fmt;

use lashloop_protocol::enums::FaultCode;

use super::drive_fault::DriveFault;
use crate::fault::timeline::FaultRecord;
use crate::timing::TimingReport;
use crate::verdict::{BrokenRule, Judgement, LinkCounts, Verdict};
use lashloop_plant::PlantError;
use lashloop_plant::metrics::{Metrics, SignalTable};
use lashloop_session::CapturedRows;

/// How a run ended.
#[derive(Debug, Clone, PartialEq)]
pub enum End {
    /// After its full duration.
    Complete,
    /// The drive latched a fault.
    DriveFault(DriveFault),
    /// The drive sent a torque answer that breaks a rule of the protocol.
    RuleBroken(BrokenRule),
    /// The drive restarted in the middle of the run.
    DriveRestarted,
    /// The plant could not be integrated any further; as a rule its state overflowed.
    Diverged(PlantError),
    /// Bench mode: the load left its travel.
    BeyondTravel {
        /// Distance of the load from zero, or from its first position if it starts anywhere.
        reached_rad: f64,
        /// The travel.
        limit_rad: f64,
    },
    /// The user asked the bench to stop.
    Interrupted,
}

impl End {
    /// Whether the drive is still in the session of the run.
    #[must_use]
    pub fn leaves_a_session(&self) -> bool {
        match self {
            Self::DriveFault(fault) => !matches!(fault.code, FaultCode::Panic | FaultCode::ProcessorFault),
            // Of a drive that breaks a rule nothing is expected any more.
            Self::RuleBroken(_) | Self::DriveRestarted => false,
            Self::Complete | Self::Diverged(_) | Self::BeyondTravel { .. } | Self::Interrupted => true,
        }
    }

    /// The rule of the protocol that the drive broke, if that ended the run.
    #[must_use]
    pub fn broken_rule(&self) -> Option<BrokenRule> {
        match self {
            Self::RuleBroken(broken) => Some(*broken),
            Self::Complete
            | Self::DriveFault(_)
            | Self::DriveRestarted
            | Self::Diverged(_)
            | Self::BeyondTravel { .. }
            | Self::Interrupted => None,
        }
    }

    /// The best verdict that a run with this end can have; `None` for no limit. A watchdog trips because of the host or the
    /// line, and an integration fails because of the plant: neither judges the controller.
    #[must_use]
    pub fn verdict(&self) -> Option<Verdict> {
        match self {
            Self::Complete => None,
            Self::DriveFault(fault) if fault.code == FaultCode::Watchdog => Some(Verdict::Invalid),
            Self::Diverged(PlantError::Chattering { .. } | PlantError::TooStiff { .. }) => {
                Some(Verdict::Invalid)
            }
            Self::DriveFault(_) | Self::RuleBroken(_) | Self::Diverged(_) | Self::BeyondTravel { .. } => {
                Some(Verdict::Fail)
            }
            Self::DriveRestarted | Self::Interrupted => Some(Verdict::Invalid),
        }
    }
}

impl fmt::Display for End {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Complete => write!(out, "complete"),
            Self::RuleBroken(broken) => write!(out, "{broken}"),
            Self::DriveRestarted => write!(
                out,
                "the drive started anew in the middle of the run; with link.on_loss = \"resume\" the bench would go on"
            ),
            Self::BeyondTravel { reached_rad, limit_rad } => write!(
                out,
                "the load reached {reached_rad:.4} rad, beyond its travel of {limit_rad} rad; the torque is off"
            ),
            Self::Interrupted => write!(out, "interrupted by the user"),
            Self::Diverged(error) => write!(out, "the plant can't be followed any further: {error}"),
            Self::DriveFault(fault) => fault.fmt(out),
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
    /// The control metrics.
    pub metrics: Metrics,
    /// The counts of the link.
    pub link: LinkCounts,
    /// The timing of the steps.
    pub timing: TimingReport,
    /// The faults that were injected, in the scenario's order.
    pub faults: Vec<FaultRecord>,
    /// Control steps made.
    pub steps: u64,
    /// Simulated time in seconds.
    pub simulated_s: f64,
    /// Time in seconds, from the start of the drive to the last answer: of the wall clock, or of the link where that is scripted.
    pub wall_s: f64,
    /// SHA-256 of the torque stream.
    pub torque_sha256: String,
    /// The drive's log texts.
    pub logs: Vec<String>,
    /// The signals of plant and drive that every step has a value for.
    pub signals: SignalTable,
    /// What the drive has captured; `None` without a `[scope]` in the scenario, or without its event.
    pub scope: Option<CapturedRows>,
}

impl Outcome {
    /// Why the verdict is not PASS, each reason as one phrase; empty for PASS.
    #[must_use]
    pub fn reasons(&self) -> Vec<String> {
        let Judgement { verdict, expectations, breaches, gate } = &self.judgement;
        let end = (self.end != End::Complete).then(|| self.end.to_string());
        let breaches = breaches.iter().map(ToString::to_string);
        let missed = expectations.iter().filter(|judged| !judged.ok).map(ToString::to_string);
        let reasons: Vec<_> = end.into_iter().chain(gate.clone()).chain(breaches).chain(missed).collect();
        match verdict {
            Verdict::Fail if reasons.is_empty() => vec!["a value of the run is not finite".to_owned()],
            Verdict::Pass | Verdict::Fail | Verdict::Invalid => reasons,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_integration_failure_is_invalid_unless_torque_caused_it() {
        let chattering = PlantError::Chattering { substep_s: 1e-3 };
        let too_stiff = PlantError::TooStiff { needed: 1e6, dt_s: 1e-3 };
        let overflow = PlantError::NotFinite { torque_nm: 1e300 };
        assert_eq!(End::Diverged(chattering).verdict(), Some(Verdict::Invalid));
        assert_eq!(End::Diverged(too_stiff).verdict(), Some(Verdict::Invalid));
        assert_eq!(End::Diverged(overflow).verdict(), Some(Verdict::Fail));
    }
}
