//! Limits of every plant's integration.

/// Largest number of substeps in one step.
pub const MAX_SUBSTEPS: u32 = 4096;

/// Mode changes within one substep above which a plant counts as chattering.
pub const MAX_EVENTS: u32 = 64;

/// Signals of one plant, at most: a step of the record has a place for each, so that the loop allocates nothing.
pub const MAX_SIGNALS: usize = 48;

/// Largest magnitude of a coordinate of a plant, in its SI unit. Torques and energies that follow from it are finite: the largest
/// is elastic, 5e216 J, at the largest stiffness and reduction ratio.
pub const MAX_COORDINATE: f64 = 1e100;

/// Whether each coordinate is a number of at most [`MAX_COORDINATE`].
pub fn are_in_range<'a>(coordinates: impl IntoIterator<Item = &'a f64>) -> bool {
    coordinates.into_iter().all(|coordinate| coordinate.abs() <= MAX_COORDINATE)
}
