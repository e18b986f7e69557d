//! The document: the size and position of every panel in the grid, then title, panels and caption.
//!
//! Plots of one row share their upper edge and plots of one column their left edge, independent of the length of titles,
//! legends and tick labels, so that curves in neighbouring panels can be compared by eye.

use super::axes::Frame;
use super::figure::{Figure, Panel};
use super::panel::Prepared;
use super::placement::Area;
use super::svg::{Label, Svg};
use super::text::wrap;
use super::theme::{self, CAPTION_PX, TITLE_PX};

const MARGIN_PX: f64 = 24.0;
const COLUMN_GAP_PX: f64 = 28.0;
const ROW_GAP_PX: f64 = 20.0;
/// Width of a panel with its labels, and height of its plot without them: alone in its row, and next to others.
const ALONE_PX: (f64, f64) = (780.0, 320.0);
const SIDE_BY_SIDE_PX: (f64, f64) = (476.0, 216.0);

impl Figure {
    /// The figure as a stand-alone SVG document.
    #[must_use]
    pub fn to_svg(&self) -> String {
        let columns = self.columns.clamp(1, self.panels.len().max(1));
        let (panel_width, plot_height) = if columns == 1 { ALONE_PX } else { SIDE_BY_SIDE_PX };
        let inner_width = columns as f64 * (panel_width + COLUMN_GAP_PX) - COLUMN_GAP_PX;

        let is_lettered = (2..=26).contains(&self.panels.len());
        let panels: Vec<Panel> = self.panels.iter().map(Panel::along_its_axis).collect();
        let prepared: Vec<Prepared> = panels
            .iter()
            .zip('a'..)
            .map(|(panel, letter)| Prepared::new(panel, is_lettered.then_some(letter), panel_width))
            .collect();
        let left_margins: Vec<f64> = (0..columns)
            .map(|column| widest(prepared.iter().skip(column).step_by(columns), Prepared::left_px))
            .collect();

        let title_lines = wrap(&self.title, TITLE_PX, inner_width);
        let caption_lines = wrap(&self.caption, CAPTION_PX, inner_width);
        let mut top = MARGIN_PX + title_lines.len() as f64 * (TITLE_PX * 1.3) + 10.0;
        let mut frames = Vec::with_capacity(prepared.len());
        for row in prepared.chunks(columns) {
            let plot_top = top + widest(row.iter(), Prepared::head_px);
            for (column, left_margin) in left_margins.iter().enumerate().take(row.len()) {
                let left = MARGIN_PX + column as f64 * (panel_width + COLUMN_GAP_PX);
                let plot = Area {
                    left: left + left_margin,
                    top: plot_top,
                    right: left + panel_width - Prepared::RIGHT_PX,
                    bottom: plot_top + plot_height,
                };
                frames.push(Frame { left, top, plot });
            }
            top = plot_top + plot_height + Prepared::FOOT_PX + ROW_GAP_PX;
        }
        let caption_top = top;
        let height = caption_top + caption_lines.len() as f64 * CAPTION_PX * 1.45 + MARGIN_PX * 0.6;
        let width = inner_width + 2.0 * MARGIN_PX;

        let mut svg = Svg::open(width, height, &self.title, &self.caption);
        svg.rectangle((0.5, 0.5), (width - 1.0, height - 1.0), theme::GROUND, Some(theme::FRAME));
        let plain = Label { x: MARGIN_PX, ..Label::new("") };
        svg.paragraph(&title_lines, 1.3, Label { y: MARGIN_PX, size_px: TITLE_PX, bold: true, ..plain });
        for (prepared, frame) in prepared.iter().zip(&frames) {
            prepared.draw(&mut svg, frame);
        }
        let caption = Label { y: caption_top, size_px: CAPTION_PX, colour: theme::SOFT_INK, ..plain };
        svg.paragraph(&caption_lines, 1.45, caption);
        svg.close()
    }
}

fn widest<'a, 'p: 'a>(
    panels: impl Iterator<Item = &'a Prepared<'p>>,
    size: impl Fn(&Prepared<'p>) -> f64,
) -> f64 {
    panels.map(size).fold(0.0, f64::max)
}
