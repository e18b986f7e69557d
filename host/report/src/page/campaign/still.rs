//! Small plots that need no script: axes with ticks around given content, in the colours of the page.

use std::fmt::Write as _;

use maud::{Markup, html};

use super::super::typeset::shown;
use lashloop_plot::span::Span;
use lashloop_plot::ticks::Ticks;

const LEFT: f64 = 52.0;
const RIGHT: f64 = 14.0;
const TOP: f64 = 8.0;
const BOTTOM: f64 = 38.0;
/// Ratio of the largest to the middle value from which an axis is logarithmic.
const WIDE: f64 = 50.0;

/// Characters of all labels along a horizontal axis.
const LABEL_CHARACTERS: usize = 54;

/// A pair of axes.
pub(super) struct Still {
    pub(super) width: f64,
    pub(super) height: f64,
    pub(super) x: Scale,
    pub(super) y: Scale,
}

/// An axis.
pub(super) enum Scale {
    Linear(Ticks),
    /// Powers of ten.
    Decades {
        first: i32,
        last: i32,
    },
    /// Places 0 to the number of labels, each label in the middle of its place.
    Named(Vec<String>),
}

impl Scale {
    /// Linear ticks around the values.
    pub(super) fn linear(values: impl Iterator<Item = f64>, intervals: i64) -> Self {
        Self::Linear(Ticks::covering(Span::of(values).unwrap_or(Span::UNIT), intervals))
    }

    /// Logarithmic if sorted positive values extend far beyond their middle.
    pub(super) fn of_sorted(values: &[f64]) -> Self {
        let positive = &values[values.partition_point(|value| *value <= 0.0)..];
        let (Some(low), Some(high)) = (positive.first(), positive.last()) else {
            return Self::linear(values.iter().copied(), 6);
        };
        if positive.len() < values.len() || *high <= WIDE * positive[positive.len() / 2] {
            return Self::linear(values.iter().copied().chain([0.0]), 6);
        }
        let (first, last) = (low.log10().floor() as i32, high.log10().ceil() as i32);
        Self::Decades { first, last: last.max(first + 1) }
    }

    /// Place on the axis, 0 to 1.
    fn fraction(&self, value: f64) -> f64 {
        match self {
            Self::Linear(ticks) => {
                let Span { low, high } = ticks.span();
                (value - low) / (high - low)
            }
            Self::Decades { first, last } => {
                (value.max(f64::MIN_POSITIVE).log10() - f64::from(*first)) / f64::from(last - first)
            }
            Self::Named(labels) => value / labels.len() as f64,
        }
    }

    fn ticks(&self) -> Vec<(f64, String)> {
        match self {
            Self::Linear(ticks) => ticks.labelled(),
            Self::Decades { first, last } => {
                let step = (last - first + 6) / 7;
                let exponents = (*first..=*last).step_by(step.max(1) as usize);
                exponents.map(|exponent| (10_f64.powi(exponent), shown(10_f64.powi(exponent)))).collect()
            }
            Self::Named(labels) => {
                // As many labels as do not overlap.
                let longest = labels.iter().map(|label| label.chars().count()).max().unwrap_or(0);
                let step = (labels.len() * (longest + 1)).div_ceil(LABEL_CHARACTERS).max(1);
                let middles = labels.iter().enumerate().step_by(step);
                middles.map(|(at, label)| (at as f64 + 0.5, label.clone())).collect()
            }
        }
    }

    /// The name of the axis, with the power of ten that its labels lack.
    fn name(&self, name: &str) -> String {
        match self {
            Self::Linear(ticks) if ticks.factor() != 0 => {
                format!("{name}, in {}", shown(10_f64.powi(ticks.factor())))
            }
            _ => name.to_owned(),
        }
    }
}

impl Still {
    pub(super) fn x_px(&self, value: f64) -> f64 {
        LEFT + (self.width - LEFT - RIGHT) * self.x.fraction(value).clamp(0.0, 1.0)
    }

    pub(super) fn y_px(&self, value: f64) -> f64 {
        TOP + (self.height - TOP - BOTTOM) * (1.0 - self.y.fraction(value).clamp(0.0, 1.0))
    }

    /// The plot. `label` describes it to screen readers.
    pub(super) fn draw(&self, label: &str, x_name: &str, y_name: &str, content: &Markup) -> Markup {
        let Self { width, height, .. } = self;
        let (right, bottom) = (width - RIGHT, height - BOTTOM);
        let (x_name, y_name) = (self.x.name(x_name), self.y.name(y_name));
        let middle = (TOP + bottom) / 2.0;
        html! {
            svg.still viewBox=(format!("0 0 {width} {height}")) role="img" aria-label=(label) {
                g.grid {
                    @for (value, _) in self.x.ticks() { @let x = px(self.x_px(value)); line x1=(x) x2=(x) y1=(px(TOP)) y2=(px(bottom)) {} }
                    @for (value, _) in self.y.ticks() { @let y = px(self.y_px(value)); line y1=(y) y2=(y) x1=(px(LEFT)) x2=(px(right)) {} }
                }
                (content)
                rect.frame x=(px(LEFT)) y=(px(TOP)) width=(px(right - LEFT)) height=(px(bottom - TOP)) {}
                @for (value, label) in self.x.ticks() {
                    text x=(px(self.x_px(value))) y=(px(bottom + 15.0)) text-anchor="middle" { (label) }
                }
                @for (value, label) in self.y.ticks() {
                    text x=(px(LEFT - 6.0)) y=(px(self.y_px(value) + 4.0)) text-anchor="end" { (label) }
                }
                text x=(px((LEFT + right) / 2.0)) y=(px(bottom + 32.0)) text-anchor="middle" { (x_name) }
                text x="12" y=(px(middle)) text-anchor="middle" transform=(format!("rotate(-90 12 {})", px(middle))) { (y_name) }
            }
        }
    }
}

/// A length with one decimal at most.
pub(super) fn px(value: f64) -> String {
    let text = format!("{value:.1}");
    text.strip_suffix(".0").unwrap_or(&text).to_owned()
}

/// A path through points.
pub(super) fn path(points: impl Iterator<Item = (f64, f64)>) -> String {
    let mut text = String::new();
    for (at, (x, y)) in points.enumerate() {
        // A string takes every text.
        let _ = write!(text, "{}{} {}", if at == 0 { "M" } else { "L" }, px(x), px(y));
    }
    text
}
