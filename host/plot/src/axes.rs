//! Axes: grid, ticks and their labels, names.

use super::figure::Axis;
use super::placement::Area;
use super::scale::Scale;
use super::svg::{Anchor, Label, Svg};
use super::text::superscript;
use super::theme::{self, TICK_PX};

/// Position of a panel and of its plot area, in pixels of the figure.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    /// Corner of the panel.
    pub(super) left: f64,
    pub(super) top: f64,
    /// The area within the axes.
    pub(super) plot: Area,
}

/// Draws grid, axis lines and tick labels.
pub(super) fn draw(svg: &mut Svg, frame: &Frame, x_scale: Scale, y_scale: Scale) {
    let upright = |x: f64| [(x, frame.plot.top), (x, frame.plot.bottom)];
    let level = |y: f64| [(frame.plot.left, y), (frame.plot.right, y)];
    let [x_ticks, y_ticks] = [x_scale, y_scale].map(|scale| scale.ticks.labelled());
    let grid: Vec<_> = (x_ticks.iter().map(|(value, _)| upright(x_scale.px(*value))))
        .chain(y_ticks.iter().map(|(value, _)| level(y_scale.px(*value))))
        .collect();
    svg.lines(&grid, theme::GRID, 1.0);
    svg.lines(&[upright(frame.plot.left), level(frame.plot.bottom)], theme::AXIS, 1.2);
    for (value, text) in x_ticks.iter().filter(|(_, text)| !text.is_empty()) {
        let (x, y) = (x_scale.px(*value), frame.plot.bottom + TICK_PX + 6.0);
        svg.text(Label { x, y, anchor: Anchor::Middle, ..tick_label(text) });
    }
    for (value, text) in &y_ticks {
        let (x, y) = (frame.plot.left - 7.0, y_scale.px(*value) + TICK_PX * 0.35);
        svg.text(Label { x, y, anchor: Anchor::End, ..tick_label(text) });
    }
}

fn tick_label(text: &str) -> Label<'_> {
    Label { size_px: TICK_PX, colour: theme::SOFT_INK, ..Label::new(text) }
}

/// Name of an axis with its unit and the power of ten of its labels, such as `torque (10⁻³ N m)`.
pub(super) fn name(axis: &Axis, factor: i32) -> String {
    let Axis { quantity, unit, .. } = axis;
    match (factor, unit.as_str()) {
        (0, "") => quantity.clone(),
        (0, unit) => format!("{quantity} ({unit})"),
        (factor, "") => format!("{quantity} (10{})", superscript(factor)),
        (factor, unit) => format!("{quantity} (10{} {unit})", superscript(factor)),
    }
}
