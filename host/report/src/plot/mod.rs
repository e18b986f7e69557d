//! Figures as SVG: plain data in, text out.

mod axes;
mod curve;
mod figure;
mod legend;
mod panel;
mod placement;
mod render;
mod scale;
pub(crate) mod span;
mod svg;
mod text;
mod theme;
pub(crate) mod ticks;

pub use figure::{Axis, Band, Figure, Mark, Panel, Role, Series};
