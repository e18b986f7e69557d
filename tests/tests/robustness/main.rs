//! What damage can and can't do.

mod damaged;
mod fuzzed;
mod lossy;
mod residual;
mod seeds;
