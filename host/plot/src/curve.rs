//! A curve in pixels: unbroken strokes, thinned without a visible difference.
//!
//! A run of 25 s at 1 kHz has 25,000 points on 400 to 700 columns of pixels. Of consecutive points within one column, the
//! first, lowest, highest and last draw the same pixels as all of them. The rule needs consecutive points in one column,
//! not rising x, so it also holds for a hysteresis. It does not shorten a curve that leaves its column with every sample.
//! If such a curve exceeds the budget, we thin it by runs of equal count and keep the extremes of each on both axes.

use std::fmt::Write;

use super::scale::{Point, Scale};
use super::span::{Span, is_drawable};

/// Largest number of points of a stroke, some 40 kB of path. A time series has at most four per column and stays below.
const BUDGET: usize = 4000;

/// Largest number of points kept per run: first, last and the extremes on both axes.
const KEPT_PER_RUN: usize = 6;

/// The strokes of a curve, broken at points that can't be drawn and thinned without losing a peak.
pub(super) fn strokes(x: &[f64], y: &[f64], x_scale: Scale, y_scale: Scale) -> Vec<Vec<Point>> {
    let points: Vec<Option<Point>> = x
        .iter()
        .zip(y)
        .map(|(&x, &y)| (is_drawable(x) && is_drawable(y)).then(|| (x_scale.px(x), y_scale.px(y))))
        .collect();
    points
        .split(Option::is_none)
        .filter(|stroke| !stroke.is_empty())
        .map(|stroke| thin(&stroke.iter().copied().flatten().collect::<Vec<_>>()))
        .collect()
}

/// Horizontal and vertical range of the points that can be drawn; the vertical one includes `levels`.
pub(super) fn spans(curves: &[(&[f64], &[f64])], levels: &[f64]) -> (Span, Span) {
    let drawable = || {
        let points = curves.iter().flat_map(|(x, y)| x.iter().copied().zip(y.iter().copied()));
        points.filter(|&(x, y)| is_drawable(x) && is_drawable(y))
    };
    let x = Span::of(drawable().map(|(x, _)| x));
    let y = Span::of(drawable().map(|(_, y)| y).chain(levels.iter().copied()));
    (x.unwrap_or(Span::UNIT), y.unwrap_or(Span::UNIT))
}

fn thin(stroke: &[Point]) -> Vec<Point> {
    let thinned = keep_extremes(stroke.chunk_by(|a, b| a.0.floor() == b.0.floor()));
    if thinned.len() <= BUDGET {
        return thinned;
    }
    let run = (thinned.len() * KEPT_PER_RUN).div_ceil(BUDGET);
    keep_extremes(thinned.chunks(run))
}

fn keep_extremes<'a>(runs: impl Iterator<Item = &'a [Point]>) -> Vec<Point> {
    let mut kept = Vec::new();
    for run in runs {
        let mut indices = [
            0,
            run.len() - 1,
            extreme(run, |best, point| point.0 < best.0),
            extreme(run, |best, point| point.0 > best.0),
            extreme(run, |best, point| point.1 < best.1),
            extreme(run, |best, point| point.1 > best.1),
        ];
        indices.sort_unstable();
        let mut previous = None;
        for index in indices {
            if previous.replace(index) != Some(index) {
                kept.push(run[index]);
            }
        }
    }
    kept
}

/// Index of the first point that no other one beats.
fn extreme(run: &[Point], beats: impl Fn(&Point, &Point) -> bool) -> usize {
    (1..run.len()).fold(0, |best, index| if beats(&run[best], &run[index]) { index } else { best })
}

/// Path data of strokes, to a tenth of a pixel. Steps are relative and taken between rounded points: the text is short and
/// rounding errors do not accumulate.
pub(super) fn path_data(strokes: &[Vec<Point>]) -> String {
    let mut data = String::new();
    for stroke in strokes {
        let mut at: Option<(i64, i64)> = None;
        for point in stroke {
            let next = ((point.0 * 10.0).round() as i64, (point.1 * 10.0).round() as i64);
            match at {
                None => write_pair(&mut data, 'M', next),
                // A stroke of one point becomes a dot: the round cap of a line without length.
                Some(last) if last == next && stroke.len() > 1 => {}
                Some(last) => write_pair(&mut data, 'l', (next.0 - last.0, next.1 - last.1)),
            }
            at = Some(next);
        }
        if stroke.len() == 1 {
            data.push_str("h0");
        }
    }
    data
}

fn write_pair(data: &mut String, command: char, (x, y): (i64, i64)) {
    data.push(command);
    write_tenths(data, x);
    if y >= 0 {
        data.push(' ');
    }
    write_tenths(data, y);
}

fn write_tenths(data: &mut String, tenths: i64) {
    let sign = if tenths < 0 { "-" } else { "" };
    let (whole, tenth) = (tenths.abs() / 10, tenths.abs() % 10);
    let written = match (whole, tenth) {
        (_, 0) => write!(data, "{sign}{whole}"),
        (0, _) => write!(data, "{sign}.{tenth}"),
        _ => write!(data, "{sign}{whole}.{tenth}"),
    };
    written.expect("writing to a string succeeds");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ticks::Ticks;

    fn scale(low: f64, high: f64) -> Scale {
        Scale::new(Ticks::covering(Span { low, high }, 10), 0.0, 400.0)
    }

    /// Noise that differs from sample to sample by far more than a pixel.
    fn noise(sample: usize) -> f64 {
        (sample.wrapping_mul(2_654_435_761) % 1_000) as f64 / 1_000.0
    }

    #[test]
    fn first_last_and_extremes_of_each_column_are_kept_in_order() {
        let stroke = [(3.1, 5.0), (3.2, 9.0), (3.3, 6.0), (3.4, 1.0), (3.5, 4.0), (3.9, 5.0), (4.0, 7.0)];
        assert_eq!(thin(&stroke), [(3.1, 5.0), (3.2, 9.0), (3.4, 1.0), (3.9, 5.0), (4.0, 7.0)]);
    }

    #[test]
    fn curve_that_leaves_its_column_with_every_sample_keeps_its_extremes_within_the_budget() {
        let mut x: Vec<f64> = (0..25_000).map(noise).collect();
        let mut y: Vec<f64> = (0..25_000).map(|sample| noise(sample + 7)).collect();
        (x[777], x[800], y[9_999], y[20_001]) = (2.0, -1.0, -1.0, 2.0);
        let strokes = strokes(&x, &y, scale(-1.0, 2.0), scale(-1.0, 2.0));
        assert!(strokes[0].len() <= BUDGET, "{} points", strokes[0].len());
        let ends = |coordinate: fn(&Point) -> f64| {
            strokes[0]
                .iter()
                .map(coordinate)
                .fold((f64::MAX, f64::MIN), |(low, high), px| (px.min(low), px.max(high)))
        };
        let plot = (scale(-1.0, 2.0).px(-1.0), scale(-1.0, 2.0).px(2.0));
        assert_eq!((ends(|point| point.0), ends(|point| point.1)), (plot, plot));
    }

    #[test]
    fn rounding_to_tenths_does_not_add_up_along_a_path() {
        let stroke: Vec<Point> = (0..=1000).map(|step| (f64::from(step) * 0.26, 0.0)).collect();
        let steps = path_data(&[stroke]).replace("M0 0", "");
        let x: f64 = steps
            .split('l')
            .skip(1)
            .map(|pair| pair.split(' ').next().map_or(0.0, |x| x.parse().unwrap_or(f64::NAN)))
            .sum();
        assert!((x - 260.0).abs() < 1e-6, "{x}");
    }
}
