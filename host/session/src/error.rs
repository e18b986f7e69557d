//! Why a session fails: which side, and how far the session got.

use std::fmt;
use std::time::Duration;

use lashloop_link::LinkError;
use lashloop_protocol::enums::{Outcome, ParameterValue, State};
use lashloop_protocol::message::{EncoderSample, Reference};
use lashloop_protocol::sequence::nearest_step;
use lashloop_protocol::wire::Payload;
use lashloop_protocol::{DriveMessage, Message, PROTOCOL_VERSION};

use crate::diagnosis::Diagnosis;

/// How far a session got.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct LastSeen {
    /// Control period of the last sample sent, or reference in bench mode, from 0 at the start; `None` before the first.
    pub sample_sent: Option<u32>,
    /// Name of the last good frame received; `None` before the first.
    pub frame: Option<&'static str>,
    /// Control period of the latest torque received; `None` before the first.
    pub torque: Option<u32>,
}

impl LastSeen {
    pub(crate) fn note(&mut self, message: &DriveMessage) {
        self.frame = Some(message.layout().name);
        let (sequence, state) = match message {
            DriveMessage::TorqueAnswer(answer) => (answer.sequence, answer.status.state),
            DriveMessage::BenchSample(sample) => (sample.sequence, sample.status.state),
            _ => return,
        };
        if state == State::Running {
            // A line may duplicate or reorder answers, so the latest step counts.
            self.torque = nearest_step(sequence, self.sample_sent.unwrap_or(0)).max(self.torque);
        }
    }
}

impl fmt::Display for LastSeen {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.sample_sent {
            Some(step) => write!(out, "last sample sent: {step}, ")?,
            None => write!(out, "no sample sent yet, ")?,
        }
        match (self.frame, self.torque) {
            (None, _) => write!(out, "no good frame received"),
            (Some(frame), None) => write!(out, "last good frame received: {frame}"),
            (Some(frame), Some(torque)) => {
                write!(out, "last good frame received: {frame}, last torque for sample {torque}")
            }
        }
    }
}

/// Why a session fails.
#[derive(Debug, thiserror::Error)]
pub enum SessionError {
    /// The line broke.
    #[error("{source} ({last_seen}){}", before(diagnosis.as_deref()))]
    Broken {
        /// Why.
        source: LinkError,
        /// How far the session got.
        last_seen: LastSeen,
        /// What arrived before, if it was no good frame.
        diagnosis: Option<Box<Diagnosis>>,
    },
    /// The drive did not answer in time.
    #[error("{} ({last_seen}): {diagnosis}", unanswered(diagnosis, waiting_for, *limit))]
    Silent {
        /// The message it left unanswered.
        waiting_for: &'static str,
        /// The timeout.
        limit: Duration,
        /// How far the session got.
        last_seen: LastSeen,
        /// What arrived instead of the answer, the probable cause and the remedy.
        diagnosis: Box<Diagnosis>,
    },
    /// Each request was answered in time or repeated, but all of them together took too long.
    #[error(
        "the drive has taken more than {} s for its answers to {requests} requests, the last of them {waiting_for} \
         ({last_seen}): a drive must answer at once; check its firmware, the baud rate and the losses on the line",
        limit.as_secs()
    )]
    Slow {
        /// The message that was awaited at the end.
        waiting_for: &'static str,
        /// Time for all answers together.
        limit: Duration,
        /// Number of requests sent, handshakes and repetitions included.
        requests: u32,
        /// How far the session got.
        last_seen: LastSeen,
    },
    /// Each sample was answered in time or given up, but all of them together took too long for a lockstep run.
    #[error(
        "the drive has taken {:.1} s for {samples} samples; a lockstep run waits {} s and link.mean_wait_ms = {} for each \
         sample: a drive must answer at once; raise link.mean_wait_ms for a slow line or a slow drive",
        waited.as_secs_f64(), allowance.as_secs(), mean_limit.as_millis()
    )]
    SlowTorques {
        /// Time spent waiting.
        waited: Duration,
        /// Samples sent.
        samples: u32,
        /// Time that a run may wait beyond the mean.
        allowance: Duration,
        /// Time for a sample on average.
        mean_limit: Duration,
    },
    /// The drive has left more control periods unanswered than a drive bridges, so it rejects every further sample.
    #[error(
        "the drive has answered nothing for {periods} control periods and takes no sample after that ({last_seen})"
    )]
    TooLongAGap {
        /// Control periods since the last answer.
        periods: u32,
        /// How far the session got.
        last_seen: LastSeen,
    },
    /// The drive has another version of the protocol.
    #[error(
        "the drive has protocol version {drive}, this bench has version {}: flash the firmware that came with \
         this bench, or use the bench that came with that firmware",
        PROTOCOL_VERSION
    )]
    Version {
        /// The drive's version.
        drive: u8,
    },
    /// The drive rejected a request.
    #[error("the drive refused {request} in state {state}: {cause} ({last_seen})")]
    Refused {
        /// Name of the request.
        request: &'static str,
        /// The drive's answer.
        outcome: Outcome,
        /// State of the drive.
        state: State,
        /// Further detail, as defined by the outcome.
        detail: u32,
        /// Why: the outcome with its detail in words, such as `SignalOfOtherLaw: signal twist_rad`.
        cause: String,
        /// How far the session got.
        last_seen: LastSeen,
    },
    /// A number of laws, signals or parameters that no drive can have.
    #[error(
        "the drive's Identity has {field} {count}, allowed are {least} to {most}: correct the firmware's Identity"
    )]
    Count {
        /// Name of the field.
        field: &'static str,
        /// Its value.
        count: u8,
        /// The smallest number allowed.
        least: usize,
        /// The largest number allowed.
        most: usize,
    },
    /// A parameter whose choices can't be requested.
    #[error(
        "the drive describes choices of {parameter} from {min} to {max} ({} to {}); choices are U32 from 0 to 255: \
         correct the firmware's description of it",
        min.ty(),
        max.ty()
    )]
    Choices {
        /// Name of the parameter.
        parameter: String,
        /// Its smallest value.
        min: ParameterValue,
        /// Its largest value.
        max: ParameterValue,
    },
}

fn unanswered(diagnosis: &Diagnosis, waiting_for: &str, limit: Duration) -> String {
    let limit_s = limit.as_secs_f64();
    if diagnosis.is_silence() {
        format!("the drive was silent for {limit_s:.1} s after {waiting_for}")
    } else {
        format!("no answer to {waiting_for} within {limit_s:.1} s")
    }
}

fn before(diagnosis: Option<&Diagnosis>) -> String {
    diagnosis.map_or_else(String::new, |diagnosis| format!("; before that {diagnosis}"))
}

impl SessionError {
    /// Whether the drive is lost: disconnected, silent or restarted.
    #[must_use]
    pub fn is_loss(&self) -> bool {
        match self {
            Self::Broken { source, .. } => matches!(source, LinkError::Disconnected | LinkError::Stuck),
            Self::Silent { .. } | Self::Slow { .. } | Self::TooLongAGap { .. } => true,
            Self::Refused { request, state, .. } => {
                [EncoderSample::LAYOUT.name, Reference::LAYOUT.name].contains(request)
                    && *state == State::Boot
            }
            _ => false,
        }
    }
}
