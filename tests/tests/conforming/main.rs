//! `lashloop conformance` and `lashloop parameters` as a user runs them, on the native twin.

mod native;
mod parameters;
