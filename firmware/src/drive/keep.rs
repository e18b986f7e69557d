//! The requests to a store.

use lashloop_protocol::message::{ForgetParameters, RecallParameters, StoreParameters};
use lashloop_protocol::wire::Payload;

/// A request, by its kind on the wire.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Keep {
    Store = StoreParameters::LAYOUT.kind as isize,
    Recall = RecallParameters::LAYOUT.kind as isize,
    Forget = ForgetParameters::LAYOUT.kind as isize,
}
