//! The wire contract seen from outside the crate.

mod c;
#[cfg(feature = "tokio-codec")]
mod codec;
mod data_sheet;
mod examples;
mod golden;
mod pinned_v1;
mod stream;
