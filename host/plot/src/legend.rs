//! The legend: line samples with their names, in rows.
//!
//! The legend lies between title and plot, so it never covers data.

use super::curve::path_data;
use super::figure::{Panel, Role};
use super::scale::Point;
use super::svg::{Label, Svg};
use super::text::width_px;
use super::theme::{self, LABEL_PX, pen};

const LINE_PX: f64 = 20.0;
const SAMPLE_PX: f64 = 24.0;
const SAMPLE_GAP_PX: f64 = 7.0;
const ENTRY_GAP_PX: f64 = 18.0;
const BAND_HEIGHT_PX: f64 = 10.0;

/// The sample next to a name.
#[derive(Debug, Clone, Copy)]
enum Sample {
    Line { role: Role, is_shaded: bool },
    Band,
}

#[derive(Debug)]
struct Entry<'a> {
    offset_px: f64,
    row: usize,
    sample: Sample,
    name: &'a str,
}

/// The entries of a panel, broken into rows.
#[derive(Debug)]
pub(super) struct Legend<'a> {
    entries: Vec<Entry<'a>>,
}

impl<'a> Legend<'a> {
    /// Breaks the entries into rows of at most `limit_px`.
    pub(super) fn new(panel: &'a Panel, limit_px: f64) -> Self {
        let lines = panel.series.iter().map(|series| {
            let sample = Sample::Line { role: series.role, is_shaded: !series.deviation.is_empty() };
            (sample, series.label.as_str())
        });
        let bands = panel.band.iter().map(|band| (Sample::Band, band.label.as_str()));
        let (mut offset_px, mut row) = (0.0, 0);
        let mut entries = Vec::new();
        for (sample, name) in lines.chain(bands) {
            let needed_px = SAMPLE_PX + SAMPLE_GAP_PX + width_px(name, LABEL_PX);
            if offset_px > 0.0 && offset_px + needed_px > limit_px {
                (offset_px, row) = (0.0, row + 1);
            }
            entries.push(Entry { offset_px, row, sample, name });
            offset_px += needed_px + ENTRY_GAP_PX;
        }
        Self { entries }
    }

    /// Height of all rows.
    pub(super) fn height_px(&self) -> f64 {
        self.entries.last().map_or(0.0, |last| (last.row + 1) as f64 * LINE_PX)
    }

    /// Draws the rows below and right of a corner.
    pub(super) fn draw(&self, svg: &mut Svg, (left, top): Point) {
        for entry in &self.entries {
            let (x, y) = (left + entry.offset_px, top + (entry.row as f64 + 0.6) * LINE_PX);
            match entry.sample {
                Sample::Line { role, is_shaded } => {
                    if is_shaded {
                        let edges = [y - BAND_HEIGHT_PX / 2.0, y + BAND_HEIGHT_PX / 2.0];
                        let [low, high] = edges.map(|y| [(x, y), (x + SAMPLE_PX, y)]);
                        let outline = vec![low[0], low[1], high[1], high[0]];
                        svg.shade(&path_data(&[outline]), pen(role).colour);
                    }
                    svg.curve(&path_data(&[vec![(x, y), (x + SAMPLE_PX, y)]]), pen(role), None);
                }
                Sample::Band => {
                    let top = y - BAND_HEIGHT_PX / 2.0;
                    svg.rectangle((x, top), (SAMPLE_PX, BAND_HEIGHT_PX), theme::BAND, None);
                    let edges = [top, top + BAND_HEIGHT_PX].map(|y| [(x, y), (x + SAMPLE_PX, y)]);
                    svg.lines(&edges, theme::BAND_EDGE, 1.0);
                }
            }
            let x = x + SAMPLE_PX + SAMPLE_GAP_PX;
            svg.text(Label { x, y: y + 0.35 * LABEL_PX, ..Label::new(entry.name) });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Axis, Series};

    #[test]
    fn entries_that_do_not_fit_go_to_the_next_row() {
        let axis = || Axis::new("time", "s");
        let names = ["pd", "merzouki", "backlash-inverse", "linear"];
        let panel = names.iter().fold(Panel::new("laws", axis(), axis()), |panel, name| {
            panel.series(Series::new(*name, Role::After, vec![], vec![]))
        });
        let legend = Legend::new(&panel, 250.0);
        let right_px =
            |entry: &Entry| entry.offset_px + SAMPLE_PX + SAMPLE_GAP_PX + width_px(entry.name, LABEL_PX);
        assert!(legend.entries.iter().all(|entry| right_px(entry) <= 250.0), "{legend:?}");
        assert_eq!(legend.entries.iter().map(|entry| entry.row).collect::<Vec<_>>(), [0, 0, 1, 1]);
        assert_eq!(legend.height_px(), 2.0 * LINE_PX);
    }
}
