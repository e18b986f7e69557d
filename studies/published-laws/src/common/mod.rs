//! What several laws have in common.
//!
//! | module | is |
//! |---|---|
//! | [`arrival`] | the end of an approach: friction holds the load |
//! | [`integral`] | an integral with a limit, which doesn't wind up |
//! | [`twist_loop`] | the inverse of the dead zone, and the motor loop that follows it |
//! | [`two_mode_filter`] | a Kalman filter with a model of contact and a model of the gap |
//!
//! No paper of this crate treats stiction. Every law therefore ends its approach as Lashloop's own laws do, or it would hunt.

pub mod arrival;
pub mod integral;
pub mod twist_loop;
pub mod two_mode_filter;
