//! Plots as SVG: data in, text out.
//!
//! A [`Figure`] is a grid of [`Panel`]s, a panel shows [`Series`] over one pair of [`Axis`]. All of it is plain data;
//! [`Figure::to_svg`] is a pure function of it, so equal runs give equal files. The stages, in order:
//!
//! | stage | file | does |
//! |---|---|---|
//! | vocabulary | `figure` | what a plot says, nothing of how it looks |
//! | scale | `ticks`, `scale` | 1-2-5 ticks that cover the data; values to pixels |
//! | curve | `curve` | breaks at values that are no numbers; thins without losing a peak |
//! | placement | `placement` | finds room for the labels of marked points beside the curves |
//! | look | `theme`, `text` | colours, sizes, widths and line breaks of text |
//! | document | `layout`, `panel`, `legend`, `axes`, `svg` | the grid, one panel and its parts, escaped XML |
//!
//! The file carries its own background and generic fonts only, has no ids, scripts or style sheets, and can therefore
//! be shown by an image viewer, in a README and inline in a report beside other figures.

#![forbid(unsafe_code)]

pub mod demo;
pub mod paper;
pub mod plot;
pub mod runs;

#[cfg(test)]
mod tests;

pub use plot::{Axis, Band, Figure, Mark, Panel, Role, Series};
