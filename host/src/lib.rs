//! Skeleton.

pub mod encoder;
pub mod picture;
pub mod plant;
