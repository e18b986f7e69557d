//! The wire contract seen from outside the crate.

#[cfg(feature = "tokio-codec")]
mod codec;
mod data_sheet;
mod examples;
mod pinned_v1;
mod stream;
