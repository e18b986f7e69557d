//! The states of the drive, each with what only it has.
//!
//! Only `Running` owns a [`Run`], and with it a held torque. Leaving a state drops what the state owned.

use core::time::Duration;

use lashloop_protocol::enums::{Outcome, State};
use lashloop_protocol::message::FaultReport;

use super::control_loop::ControlLoop;
use super::run::{Run, Source};
use super::safety::Violation;
use crate::law::{DriveParameters, LawSet};

#[expect(clippy::large_enum_variant, reason = "a drive has one life, and no heap")]
pub(super) enum Lifecycle<L: LawSet> {
    /// Before the first session.
    Boot,
    Idle {
        session: u32,
    },
    /// The controller is built when arming, so that inconsistent parameters are found before the start.
    Armed {
        session: u32,
        control: ControlLoop<L>,
    },
    Running {
        session: u32,
        run: Run<L>,
    },
    /// The first fault stays latched until it is cleared: later ones are usually its consequence.
    Faulted {
        /// `None` if the fault came before the first session.
        session: Option<u32>,
        report: FaultReport,
    },
}

impl<L: LawSet> Lifecycle<L> {
    pub(super) fn state(&self) -> State {
        match self {
            Self::Boot => State::Boot,
            Self::Idle { .. } => State::Idle,
            Self::Armed { .. } => State::Armed,
            Self::Running { .. } => State::Running,
            Self::Faulted { .. } => State::Faulted,
        }
    }

    pub(super) fn session(&self) -> Option<u32> {
        match self {
            Self::Boot => None,
            Self::Idle { session } | Self::Armed { session, .. } | Self::Running { session, .. } => {
                Some(*session)
            }
            Self::Faulted { session, .. } => *session,
        }
    }

    pub(super) fn run(&self) -> Option<&Run<L>> {
        if let Self::Running { run, .. } = self { Some(run) } else { None }
    }

    /// The latched fault.
    pub(super) fn fault(&self) -> Option<FaultReport> {
        if let Self::Faulted { report, .. } = self { Some(*report) } else { None }
    }

    pub(super) fn check_time(&self, now: Duration) -> Result<(), Violation> {
        self.run().map_or(Ok(()), |run| run.check_time(now))
    }

    /// Opens a session. Another one than the present disarms the drive; a latched fault stays.
    pub(super) fn open_session(&mut self, session: u32) {
        if let Self::Faulted { session: present, .. } = self {
            *present = Some(session);
        } else if self.session() != Some(session) {
            *self = Self::Idle { session };
        }
    }

    /// The control loop of an armed or running drive.
    pub(super) fn control(&mut self) -> Option<&mut ControlLoop<L>> {
        match self {
            Self::Armed { control, .. } => Some(control),
            Self::Running { run, .. } => Some(run.control()),
            Self::Boot | Self::Idle { .. } | Self::Faulted { .. } => None,
        }
    }

    /// Starts the run of an armed drive.
    pub(super) fn start(
        &mut self,
        parameters: &DriveParameters,
        source: Source,
        now: Duration,
    ) -> Result<(), Outcome> {
        match core::mem::replace(self, Self::Boot) {
            Self::Armed { session, control } => {
                *self = Self::Running { session, run: Run::new(control, parameters, source, now) };
                Ok(())
            }
            other => {
                *self = other;
                Err(Outcome::WrongState)
            }
        }
    }

    pub(super) fn stop(&mut self) -> Result<(), Outcome> {
        match *self {
            Self::Boot | Self::Faulted { .. } => Err(Outcome::WrongState),
            Self::Idle { session } | Self::Armed { session, .. } | Self::Running { session, .. } => {
                *self = Self::Idle { session };
                Ok(())
            }
        }
    }

    pub(super) fn latch(&mut self, report: FaultReport) {
        if self.fault().is_none() {
            *self = Self::Faulted { session: self.session(), report };
        }
    }

    /// Clears the latched fault. Without a session the drive returns to `Boot`: clearing opens none.
    pub(super) fn clear_fault(&mut self) -> Result<(), Outcome> {
        let Self::Faulted { session, .. } = *self else { return Err(Outcome::WrongState) };
        *self = session.map_or(Self::Boot, |session| Self::Idle { session });
        Ok(())
    }
}
