//! The signals that telemetry carries.

use lashloop_protocol::enums::Outcome;
use lashloop_protocol::message::Subscribe;

use crate::client::Session;
use crate::error::SessionError;
use crate::signals::{DriveSignal, Subscription};

/// Why a drive doesn't take a subscription.
#[derive(Debug, thiserror::Error)]
pub enum SubscribeError {
    /// The drive rejected it.
    #[error("the drive answered {cause}")]
    Rejected {
        /// The drive's answer.
        outcome: Outcome,
        /// The same in words.
        cause: String,
    },
    /// The session failed.
    #[error(transparent)]
    Session(#[from] SessionError),
}

impl Session {
    /// The signal of this name.
    #[must_use]
    pub fn signal(&self, name: &str) -> Option<&DriveSignal> {
        self.signals.iter().find(|it| it.signal.name == name)
    }

    /// Requests telemetry of these signals from now on, instead of an earlier subscription. A reset ends it.
    ///
    /// # Errors
    /// The drive rejected the subscription or is silent, or the line broke.
    pub fn subscribe(&mut self, subscription: Subscription) -> Result<(), SubscribeError> {
        let request = Subscribe { signals: subscription.bits(), every: subscription.every };
        let reply = self.result(request)?.with;
        if reply.outcome != Outcome::Accepted {
            let cause = self.line.cause_of(reply, &self.parameters, &self.signals);
            return Err(SubscribeError::Rejected { outcome: reply.outcome, cause });
        }
        self.subscription = subscription;
        // Telemetry of the subscription before has other values.
        self.line.telemetry = None;
        Ok(())
    }
}
