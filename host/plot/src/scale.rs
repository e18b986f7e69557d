//! From values to pixels.

use super::span::Span;
use super::ticks::Ticks;

/// A point in pixels of the figure, y downwards.
pub(super) type Point = (f64, f64);

/// One axis of a panel: its ticks and where they lie, in pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Scale {
    pub(super) ticks: Ticks,
    span: Span,
    start_px: f64,
    length_px: f64,
}

impl Scale {
    /// Maps the first tick to `start_px` and the last to `end_px`, which is the smaller one on a vertical axis.
    pub(super) fn new(ticks: Ticks, start_px: f64, end_px: f64) -> Self {
        Self { ticks, span: ticks.span(), start_px, length_px: end_px - start_px }
    }

    /// Position of a value, in pixels.
    pub(super) fn px(&self, value: f64) -> f64 {
        self.start_px + self.length_px * ((value - self.span.low) / (self.span.high - self.span.low))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_and_last_tick_lie_at_the_ends_of_the_axis() {
        let scale = Scale::new(Ticks::covering(Span { low: -1.0, high: 1.0 }, 4), 200.0, 0.0);
        assert_eq!((scale.px(-1.0), scale.px(0.0), scale.px(1.0)), (200.0, 100.0, 0.0));
    }
}
