//! One panel: title, legend, axes, band, curves and marks.

use super::axes::{self, Frame};
use super::curve::{path_data, spans, strokes};
use super::figure::Panel;
use super::legend::Legend;
use super::placement::{Area, place};
use super::scale::{Point, Scale};
use super::span::{Span, is_drawable};
use super::svg::{Anchor, Label, Svg};
use super::text::{width_px, wrap};
use super::theme::{self, LABEL_PX, PANEL_TITLE_PX, TICK_PX, pen};
use super::ticks::Ticks;

const X_INTERVALS: i64 = 8;
const Y_INTERVALS: i64 = 7;
const TITLE_SPACING: f64 = 1.3;
const TITLE_LINE_PX: f64 = PANEL_TITLE_PX * TITLE_SPACING;
const RING_PX: f64 = 4.0;
/// Bold text is wider than plain by this factor.
const BOLD: f64 = 1.1;

/// A panel with its ticks and line breaks, so that its size is known before it is drawn.
#[derive(Debug)]
pub(super) struct Prepared<'a> {
    panel: &'a Panel,
    title_lines: Vec<String>,
    legend: Legend<'a>,
    x_ticks: Ticks,
    y_ticks: Ticks,
}

impl<'a> Prepared<'a> {
    /// Margin right of the plot: half of the last tick label.
    pub(super) const RIGHT_PX: f64 = 14.0;
    /// Margin below the plot: tick labels and axis name.
    pub(super) const FOOT_PX: f64 = 44.0;

    /// Sets ticks and line breaks; `letter` precedes the title.
    pub(super) fn new(panel: &'a Panel, letter: Option<char>, width: f64) -> Self {
        let title = letter.map_or(panel.title.clone(), |letter| format!("{letter}) {}", panel.title));
        let (x_span, y_span) = data_spans(panel);
        Self {
            panel,
            title_lines: wrap(&title, PANEL_TITLE_PX, width),
            legend: Legend::new(panel, width),
            x_ticks: match panel.x_axis.is_logarithmic {
                true => Ticks::Decades(x_span),
                false => Ticks::covering(x_span, X_INTERVALS),
            },
            y_ticks: Ticks::covering(y_span, Y_INTERVALS),
        }
    }

    /// Margin above the plot: title and legend.
    pub(super) fn head_px(&self) -> f64 {
        self.title_lines.len() as f64 * TITLE_LINE_PX + self.legend.height_px() + 10.0
    }

    /// Margin left of the plot: tick labels and axis name.
    pub(super) fn left_px(&self) -> f64 {
        let labels = self.y_ticks.labelled();
        let ticks = labels.iter().map(|(_, label)| width_px(label, TICK_PX)).fold(0.0, f64::max);
        LABEL_PX + 14.0 + ticks + 8.0
    }

    /// Draws the panel into its frame.
    pub(super) fn draw(&self, svg: &mut Svg, frame: &Frame) {
        let x_scale = Scale::new(self.x_ticks, frame.plot.left, frame.plot.right);
        let y_scale = Scale::new(self.y_ticks, frame.plot.bottom, frame.plot.top);
        self.draw_head(svg, frame);
        self.draw_band(svg, frame, y_scale);
        axes::draw(svg, frame, x_scale, y_scale);
        self.draw_axis_names(svg, frame);
        let curves = self.draw_curves(svg, x_scale, y_scale);
        if curves.is_empty() {
            let (x, y) =
                ((frame.plot.left + frame.plot.right) / 2.0, (frame.plot.top + frame.plot.bottom) / 2.0);
            let label =
                Label { x, y, colour: theme::SOFT_INK, anchor: Anchor::Middle, ..Label::new("no data") };
            svg.text(label);
        }
        self.draw_marks(svg, frame, x_scale, y_scale, &curves);
    }

    fn draw_head(&self, svg: &mut Svg, frame: &Frame) {
        let title =
            Label { x: frame.left, y: frame.top, size_px: PANEL_TITLE_PX, bold: true, ..Label::new("") };
        svg.paragraph(&self.title_lines, TITLE_SPACING, title);
        let legend_top = frame.top + self.title_lines.len() as f64 * TITLE_LINE_PX;
        self.legend.draw(svg, (frame.left, legend_top));
    }

    fn draw_band(&self, svg: &mut Svg, frame: &Frame, y_scale: Scale) {
        let Some(band) =
            self.panel.band.as_ref().filter(|band| is_drawable(band.low) && is_drawable(band.high))
        else {
            return;
        };
        let (low, high) = (y_scale.px(band.low.min(band.high)), y_scale.px(band.low.max(band.high)));
        let width = frame.plot.right - frame.plot.left;
        svg.rectangle((frame.plot.left, high), (width, low - high), theme::BAND, None);
        let edges = [low, high].map(|y| [(frame.plot.left, y), (frame.plot.right, y)]);
        svg.lines(&edges, theme::BAND_EDGE, 1.0);
    }

    fn draw_axis_names(&self, svg: &mut Svg, frame: &Frame) {
        let name = axes::name(&self.panel.x_axis, self.x_ticks.factor());
        let x = (frame.plot.left + frame.plot.right) / 2.0;
        let y = frame.plot.bottom + Self::FOOT_PX - 5.0;
        svg.text(Label { x, y, anchor: Anchor::Middle, ..Label::new(&name) });
        let name = axes::name(&self.panel.y_axis, self.y_ticks.factor());
        let y = (frame.plot.top + frame.plot.bottom) / 2.0;
        // The name of a signal may be longer than the plot is high.
        let fit = (frame.plot.bottom - frame.plot.top) / width_px(&name, 1.0);
        let size_px = LABEL_PX.min((10.0 * fit).floor() / 10.0);
        let x = frame.left + LABEL_PX;
        svg.upright_text(Label { x, y, size_px, anchor: Anchor::Middle, ..Label::new(&name) });
    }

    /// Draws the curves and returns their strokes, which labels of marks must avoid.
    fn draw_curves(&self, svg: &mut Svg, x_scale: Scale, y_scale: Scale) -> Vec<Vec<Point>> {
        for series in &self.panel.series {
            let [low, high] = series.edges().map(|y| strokes(&series.x, &y, x_scale, y_scale));
            for (low, high) in low.into_iter().zip(high) {
                let outline: Vec<_> = low.into_iter().chain(high.into_iter().rev()).collect();
                svg.shade(&path_data(&[outline]), pen(series.role).colour);
            }
        }
        let mut drawn = Vec::new();
        for series in &self.panel.series {
            let strokes = strokes(&series.x, &series.y, x_scale, y_scale);
            if !strokes.is_empty() {
                svg.curve(&path_data(&strokes), pen(series.role), Some(&series.label));
            }
            drawn.extend(strokes);
        }
        drawn
    }

    fn draw_marks(
        &self,
        svg: &mut Svg,
        frame: &Frame,
        x_scale: Scale,
        y_scale: Scale,
        curves: &[Vec<Point>],
    ) {
        let drawable = self.panel.marks.iter().filter(|mark| is_drawable(mark.x) && is_drawable(mark.y));
        let marks: Vec<_> = drawable.map(|mark| (mark, (x_scale.px(mark.x), y_scale.px(mark.y)))).collect();
        let mut labels: Vec<Area> = Vec::new();
        for &(mark, point) in &marks {
            let colour = pen(mark.role).colour;
            let rings = marks.iter().filter(|(_, other)| *other != point);
            let rings = rings.map(|(_, other)| Area::around(*other, 2.0 * RING_PX, 2.0 * RING_PX));
            let taken: Vec<Area> = rings.chain(labels.iter().copied()).collect();
            let size = (BOLD * width_px(&mark.label, LABEL_PX), LABEL_PX);
            let area = place(point, size, frame.plot, curves, &taken);
            svg.lines(&[[point, area.nearest(point)]], colour, 1.0);
            svg.ring(point, RING_PX, colour);
            let x = (area.left + area.right) / 2.0;
            let y = area.bottom - 2.0;
            svg.text(Label { x, y, colour, anchor: Anchor::Middle, bold: true, ..Label::new(&mark.label) });
            labels.push(area);
        }
    }
}

/// The ranges of curves, shades, marks and band.
fn data_spans(panel: &Panel) -> (Span, Span) {
    let (mark_x, mark_y): (Vec<f64>, Vec<f64>) = panel.marks.iter().map(|mark| (mark.x, mark.y)).unzip();
    let shades: Vec<_> = panel.series.iter().map(|series| (&*series.x, series.edges())).collect();
    let mut curves: Vec<(&[f64], &[f64])> =
        panel.series.iter().map(|series| (&*series.x, &*series.y)).collect();
    curves.extend(shades.iter().flat_map(|(x, edges)| edges.iter().map(|y| (*x, &**y))));
    curves.push((&mark_x, &mark_y));
    let edges: Vec<f64> = panel.band.iter().flat_map(|band| [band.low, band.high]).collect();
    spans(&curves, &edges)
}
