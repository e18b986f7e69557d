//! The frame of a panel: what its parts are placed by.

/// Position of a panel and of its plot area, in pixels of the figure.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) plot_left: f64,
    pub(super) plot_top: f64,
    pub(super) plot_right: f64,
    pub(super) plot_bottom: f64,
}
