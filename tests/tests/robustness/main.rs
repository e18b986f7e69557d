//! Damaged frames, lossy links, and the seeds of the fuzzers.

mod damaged;
mod fuzz_corpus;
mod lossy;
mod seeds;
mod undetected_errors;
mod wrong_answers;
