//! Where the drive is in a run.

use lashloop_protocol::message::EncoderSample;

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

impl Phase {
    /// The step of the drive's first sample; `None` before it was sent.
    pub(super) fn origin(self) -> Option<u32> {
        match self {
            Self::AwaitingFirstAnswer { origin, .. } | Self::Running { origin } => Some(origin),
            Self::Started | Self::Restarting => None,
        }
    }
}
