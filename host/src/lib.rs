//! Skeleton.

pub mod metrics;
pub mod record;
pub mod reference;
pub mod scenario;
pub mod verdict;
