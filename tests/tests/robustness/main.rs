//! What damage can and can't do.

mod damaged;
mod fuzzed;
mod residual;
mod seeds;
