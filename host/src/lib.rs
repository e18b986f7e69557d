//! Skeleton.

pub mod encoder;
pub mod metrics;
pub mod picture;
pub mod plant;
pub mod record;
pub mod reference;
pub mod scenario;
pub mod verdict;
