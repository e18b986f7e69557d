//! `lashloop conformance` and `lashloop parameters` as a user runs them, on the native twin; and the frame of the battery, on
//! drives that are right or broken as a whole.

mod altered;
mod bench_mode;
mod frame;
mod native;
mod parameters;
