//! When an exchange took place.

use std::time::Instant;

/// The timestamps of one exchange on the bench's side, as [`Line::timestamp`](crate::line::Line::timestamp) gives them.
#[derive(Debug, Clone, Copy)]
pub struct Timestamps {
    /// Before the sample was written to the link.
    pub asked: Instant,
    /// When the link had taken the sample.
    pub sent: Instant,
    /// When the bytes that ended the wait were read.
    pub arrived: Instant,
    /// When those bytes were decoded.
    pub decoded: Instant,
}
