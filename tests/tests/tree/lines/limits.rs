//! Most code lines of each package.

/// By the package's folder. A limit may only fall; a new package takes its lines from others.
pub(super) const LIMITS: &[(&str, usize)] = &[("host/bench", 12_000)];
