//! Skeleton.

pub mod encoder;
pub mod plant;
