//! Where the drive is in a run.

use lashloop_protocol::message::EncoderSample;

use super::error::RunError;
use super::simulator::Simulator;

/// Where the drive is in a run, as the loop sees it.
#[derive(Debug, Clone, Copy)]
pub(super) enum Phase {
    /// The drive is started and waits for its first sample.
    Started,
    /// The first sample is sent and not answered. A drive takes no other sample first, so it is retransmitted unchanged in
    /// every step: the drive may have taken it, and only the answer was lost.
    AwaitingFirstAnswer {
        /// The sample.
        first: EncoderSample,
        /// The step in which it was sent first.
        origin: u32,
    },
    /// The drive has answered its first sample.
    Running {
        /// The step of the first sample: number 0 of the drive's count.
        origin: u32,
    },
    /// A lost drive is set up again and is to be started in the next step that sends a sample.
    Restarting,
}

/// A sample to be sent.
pub(super) struct Request {
    /// Its number since the start of the drive.
    pub(super) number: u32,
    pub(super) sample: EncoderSample,
    pub(super) is_retransmission: bool,
}

impl Phase {
    /// The request of a step with this sample; `None` while the drive is not started.
    ///
    /// # Errors
    /// The sample is to be the first one, and no drive can start with it.
    pub(super) fn request(
        &mut self,
        step: u32,
        sample: EncoderSample,
        simulator: &Simulator,
    ) -> Result<Option<Request>, RunError> {
        Ok(match *self {
            Self::Started => {
                simulator.check_start(&sample)?;
                *self = Self::AwaitingFirstAnswer { first: sample, origin: step };
                Some(Request { number: 0, sample, is_retransmission: false })
            }
            Self::AwaitingFirstAnswer { first, .. } => {
                Some(Request { number: 0, sample: first, is_retransmission: true })
            }
            Self::Running { origin } => {
                Some(Request { number: step - origin, sample, is_retransmission: false })
            }
            Self::Restarting => None,
        })
    }

    /// The drive has answered a sample.
    pub(super) fn note_answer(&mut self) {
        if let Self::AwaitingFirstAnswer { origin, .. } = *self {
            *self = Self::Running { origin };
        }
    }

    /// The step of the drive's first sample; `None` before it was sent.
    pub(super) fn origin(self) -> Option<u32> {
        match self {
            Self::AwaitingFirstAnswer { origin, .. } | Self::Running { origin } => Some(origin),
            Self::Started | Self::Restarting => None,
        }
    }
}
