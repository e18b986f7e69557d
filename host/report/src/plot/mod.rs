//! Figures as SVG: plain data in, text out.

mod axes;
mod curve;
mod figure;
mod legend;
mod panel;
mod placement;
mod render;
mod scale;
mod span;
mod svg;
mod text;
mod theme;
mod ticks;

pub use figure::{Axis, Band, Figure, Mark, Panel, Role, Series};
