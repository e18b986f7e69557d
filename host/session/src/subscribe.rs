//! The signals that telemetry carries.

use lashloop_protocol::enums::Outcome;
use lashloop_protocol::message::Subscribe;

use crate::client::Session;
use crate::error::{SessionError, quoted};
use crate::signals::{DriveSignal, Subscription};

/// Why a drive doesn't take a subscription.
#[derive(Debug, thiserror::Error)]
pub enum SubscribeError {
    /// The drive rejected it.
    #[error("the drive answered {outcome:?}{}", quoted(log))]
    Rejected {
        /// The drive's answer.
        outcome: Outcome,
        /// The drive's log texts since the request; empty if it sent none.
        log: String,
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
        let log_mark = self.line.logs.mark();
        let (outcome, _) = self.result(request)?.with;
        if outcome != Outcome::Accepted {
            let log = self.line.logs.since(log_mark).join("; ");
            return Err(SubscribeError::Rejected { outcome, log });
        }
        self.subscription = subscription;
        // Telemetry of the subscription before has other values.
        self.line.telemetry = None;
        Ok(())
    }
}
