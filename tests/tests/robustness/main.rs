//! What damage can and can't do.

mod damaged;
mod fuzz_corpus;
mod lossy;
mod seeds;
mod undetected_errors;
