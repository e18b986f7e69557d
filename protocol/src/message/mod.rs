//! The messages: fields, sender, and when each is sent.
//!
//! A new message takes a declaration and a row of the table in [`host`] or [`drive`].

pub mod drive;
pub mod host;
mod interface;

pub use drive::*;
pub use host::*;
pub use interface::{Message, Numbered};
