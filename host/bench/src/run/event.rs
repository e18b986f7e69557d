//! What happens in a run besides its steps, at the moment that it happens.

use crate::fault::timeline::FaultEdge;
use lashloop_session::LogEntry;

/// An event of a run.
#[derive(Debug, Clone, PartialEq)]
pub enum Event {
    /// An injected fault begins or ends.
    Fault(FaultEdge),
    /// The drive has sent a text, or the bench remarks something about it.
    Log(LogEntry),
}
