//! Figures as SVG: plain data in, text out.

pub(crate) mod axes;
pub(crate) mod curve;
mod figure;
pub(crate) mod layout;
pub(crate) mod legend;
pub(crate) mod panel;
pub(crate) mod placement;
pub(crate) mod scale;
pub(crate) mod svg;
pub(crate) mod text;
pub(crate) mod theme;
pub(crate) mod ticks;

pub use figure::{Axis, Band, Figure, Mark, Panel, Role, Series};
