//! Plots as SVG: data in, text out.
//!
//! A [`Figure`] is a grid of [`Panel`]s; a panel shows [`Series`] over one pair of [`Axis`]. All of it is plain data;
//! [`Figure::to_svg`] is a pure function of it, so equal runs give equal files. Its stages, in order:
//!
//! | stage | file | does |
//! |---|---|---|
//! | data | `figure` | what a plot shows |
//! | scale | `span`, `ticks`, `scale` | 1-2-5 ticks that cover the data; values to pixels |
//! | curve | `curve` | breaks at non-finite values; thins without losing a peak |
//! | style | `theme`, `text` | colours, sizes, widths and line breaks of text |
//! | placement | `placement` | free space for the labels of marked points |
//! | drawing | `axes`, `legend`, `panel` | the area of a plot; one panel and its parts |
//! | document | `svg`, [`xml`], `render` | escaped XML; the grid with title and caption |
//!
//! The file carries its own background, uses generic fonts only and has no ids, scripts or style sheets. An image viewer
//! shows it, and so does a README or an HTML report next to other figures.

#![forbid(unsafe_code)]

mod axes;
mod curve;
mod figure;
mod legend;
mod panel;
mod placement;
mod render;
mod scale;
pub mod span;
mod svg;
mod text;
mod theme;
pub mod ticks;
pub mod xml;

#[cfg(test)]
mod tests;

pub use figure::{Axis, Band, Figure, Mark, Panel, Role, Series};
