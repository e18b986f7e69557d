//! The bench: a simulated plant with gear backlash, and everything on the PC that runs a drive against it.

pub mod metrics;
pub mod record;
pub mod reference;
pub mod scenario;
pub mod verdict;
