//! The wire contract seen from outside the crate.

mod c;
#[cfg(feature = "tokio-codec")]
mod codec;
mod data_sheet;
mod document;
mod examples;
mod golden;
mod markdown;
mod pinned_v1;
mod stream;
