//! The state diagram: which state may follow which, and by which cause.

use lashloop_protocol::HostMessage;
use lashloop_protocol::enums::State;

/// What preceded a state.
pub enum Cause {
    /// A whole request.
    Request(HostMessage),
    /// A whole request of a kind that the drive doesn't know.
    UnknownRequest(u8),
    /// Device time, or bytes that aren't a message.
    NoRequest,
}

/// Whether the state diagram has this transition.
pub fn may_change(before: State, after: State, cause: &Cause) -> bool {
    use HostMessage as Message;
    use State::{Armed, Boot, Faulted, Idle, Running};
    match (before, after, cause) {
        (_, Boot, Cause::Request(Message::Reset(_)))
        | (_, Faulted, Cause::Request(Message::EmergencyStop(_))) => true,
        (_, _, Cause::Request(Message::Reset(_) | Message::EmergencyStop(_))) => false,
        (_, _, Cause::UnknownRequest(_)) => before == after,
        (Faulted, Idle | Boot, Cause::Request(Message::ClearFault(_))) => true,
        (Faulted, _, Cause::Request(Message::ClearFault(_))) => false,
        (Running, Faulted, Cause::NoRequest | Cause::Request(Message::EncoderSample(_))) => true,
        (Armed | Running, Idle, Cause::Request(Message::Stop(_) | Message::Hello(_))) => true,
        (Boot, Idle, Cause::Request(Message::Hello(_))) => true,
        (Idle, Armed, Cause::Request(Message::Arm(_))) => true,
        (Armed, Running, Cause::Request(Message::Start(_))) => true,
        _ => before == after,
    }
}
