//! What damage can and can't do.

mod damaged;
mod fuzzed;
mod lossy;
mod seeds;
mod undetected_errors;
