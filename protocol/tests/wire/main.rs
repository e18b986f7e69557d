//! The wire contract through the public interface of the crate.

mod c;
#[cfg(feature = "tokio-codec")]
mod codec;
mod crc_distance;
mod data_sheet;
mod digits;
mod document;
mod examples;
mod golden;
mod markdown;
mod pinned_v1;
mod stream;
