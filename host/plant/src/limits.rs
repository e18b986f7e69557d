//! Limits of every plant's integration.

/// Largest number of substeps in one step.
pub const MAX_SUBSTEPS: u32 = 4096;

/// Mode changes within one substep above which a plant counts as chattering.
pub const MAX_EVENTS: u32 = 64;

/// Signals of one plant, at most: a step of the record has a place for each, so that the loop allocates nothing.
pub const MAX_SIGNALS: usize = 48;
