//! The frame of a panel: what its parts are placed by.

/// Position of a panel and of its plot area, in pixels of the figure.
use super::placement::Area;

#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    /// Corner of the panel.
    pub(super) left: f64,
    pub(super) top: f64,
    /// The area within the axes.
    pub(super) plot: Area,
}
