//! Placement of the labels of marked points: near the point, clear of curves, other labels and the frame.
//!
//! We evaluate a fixed list of positions around the point and take the cheapest. The cost of a position is its distance,
//! plus more than any distance for each obstacle. A label covers data only if the panel has no free position.

use super::scale::Point;

/// Sides of the point to try, the preferred ones first: a tie goes to the earlier one. At 1 the label lies wholly on
/// that side, at 0 it is centred.
const DIRECTIONS: [Point; 12] = [
    (0.0, -1.0),
    (1.0, -1.0),
    (-1.0, -1.0),
    (0.5, -1.0),
    (-0.5, -1.0),
    (1.0, 0.0),
    (-1.0, 0.0),
    (0.0, 1.0),
    (1.0, 1.0),
    (-1.0, 1.0),
    (0.5, 1.0),
    (-0.5, 1.0),
];

/// Distances between point and label to try, in pixels.
const DISTANCES_PX: [f64; 9] = [9.0, 14.0, 20.0, 28.0, 38.0, 50.0, 66.0, 88.0, 120.0];

/// Free space kept around a label, in pixels.
const CLEARANCE_PX: f64 = 4.0;

/// More than the longest distance can cost.
const COVERED: f64 = 1000.0;

/// An upright rectangle in pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Area {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) right: f64,
    pub(super) bottom: f64,
}

impl Area {
    /// The rectangle of a size around a centre.
    pub(super) fn around(centre: Point, width: f64, height: f64) -> Self {
        let (left, top) = (centre.0 - width / 2.0, centre.1 - height / 2.0);
        Self { left, top, right: left + width, bottom: top + height }
    }

    /// The point of the rectangle next to another point; a leader from that point ends here.
    pub(super) fn nearest(&self, point: Point) -> Point {
        (point.0.clamp(self.left, self.right), point.1.clamp(self.top, self.bottom))
    }

    fn contains(&self, inner: &Self) -> bool {
        self.left <= inner.left
            && self.top <= inner.top
            && self.right >= inner.right
            && self.bottom >= inner.bottom
    }

    fn overlaps(&self, other: &Self) -> bool {
        self.left < other.right
            && other.left < self.right
            && self.top < other.bottom
            && other.top < self.bottom
    }

    /// Whether the straight line between two points passes through (clipping after Liang and Barsky).
    fn is_crossed_by(&self, from: Point, to: Point) -> bool {
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        for (slope, distance) in [
            (-dx, from.0 - self.left),
            (dx, self.right - from.0),
            (-dy, from.1 - self.top),
            (dy, self.bottom - from.1),
        ] {
            if slope == 0.0 {
                if distance < 0.0 {
                    return false;
                }
            } else if slope < 0.0 {
                enter = enter.max(distance / slope);
            } else {
                leave = leave.min(distance / slope);
            }
        }
        enter <= leave
    }
}

/// Finds the area for a label of a size that belongs to `point`, inside `frame`. Neither the label nor the leader from
/// the point to it shall cross what is `taken`.
pub(super) fn place(
    point: Point,
    (width, height): (f64, f64),
    frame: Area,
    strokes: &[Vec<Point>],
    taken: &[Area],
) -> Area {
    let cost = |area: &Area| {
        let clearance = Area::around(
            ((area.left + area.right) / 2.0, (area.top + area.bottom) / 2.0),
            width + 2.0 * CLEARANCE_PX,
            height + 2.0 * CLEARANCE_PX,
        );
        let covers_curve = strokes.iter().any(|stroke| {
            stroke.windows(2).any(|ends| clearance.is_crossed_by(ends[0], ends[1]))
                || stroke.iter().any(|point| clearance.is_crossed_by(*point, *point))
        });
        let covers_label = taken.iter().any(|other| clearance.overlaps(other));
        let leader_end = area.nearest(point);
        let leader_crosses_label = taken.iter().any(|other| other.is_crossed_by(point, leader_end));
        let outside = !frame.contains(&clearance);
        [(outside, 4.0), (covers_label, 2.0), (covers_curve, 1.0), (leader_crosses_label, 0.5)]
            .into_iter()
            .map(|(is_so, weight)| if is_so { weight * COVERED } else { 0.0 })
            .sum::<f64>()
    };
    DISTANCES_PX
        .iter()
        .flat_map(|distance| DIRECTIONS.iter().map(move |direction| (distance, direction)))
        .map(|(distance, direction)| {
            let centre = (
                point.0 + direction.0 * (distance + width / 2.0),
                point.1 + direction.1 * (distance + height / 2.0),
            );
            let area = Area::around(centre, width, height);
            (distance + cost(&area), area)
        })
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map_or(Area::around(point, width, height), |(_, area)| area)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: Area = Area { left: 0.0, top: 0.0, right: 400.0, bottom: 200.0 };

    #[test]
    fn label_keeps_clear_of_the_curve_and_of_other_labels() {
        let curve: Vec<Point> =
            (0..400).map(|x| (f64::from(x), 100.0 + 40.0 * (f64::from(x) / 15.0).sin())).collect();
        let strokes = [curve];
        let mut taken = Vec::new();
        for x in [40.0, 200.0, 230.0, 390.0] {
            let area = place((x, 100.0), (80.0, 14.0), FRAME, &strokes, &taken);
            assert!(FRAME.contains(&area), "{area:?} leaves the frame");
            assert!(
                !strokes[0].windows(2).any(|ends| area.is_crossed_by(ends[0], ends[1])),
                "{area:?} covers the curve"
            );
            assert!(!taken.iter().any(|other| area.overlaps(other)), "{area:?} covers a label");
            taken.push(area);
        }
    }

    #[test]
    fn leader_passes_no_other_label_if_there_is_another_way() {
        // The point sits in a box open to the top, and the only short way out leads through the other label.
        let walls = [150.0, 250.0].map(|x| vec![(x, 40.0), (x, 200.0)]);
        let floors = [112.0, 128.0, 144.0, 160.0, 176.0, 192.0].map(|y| vec![(150.0, y), (250.0, y)]);
        let strokes: Vec<_> = walls.into_iter().chain(floors).collect();
        let other = Area { left: 165.0, top: 70.0, right: 235.0, bottom: 84.0 };
        let point = (200.0, 100.0);
        let area = place(point, (60.0, 14.0), FRAME, &strokes, &[other]);
        assert!(!other.is_crossed_by(point, area.nearest(point)), "{area:?}");
    }

    #[test]
    fn label_without_a_free_spot_still_stays_in_the_frame() {
        let hatch: Vec<Vec<Point>> =
            (0..40).map(|row| vec![(0.0, 5.0 * f64::from(row)), (400.0, 5.0 * f64::from(row))]).collect();
        let area = place((395.0, 5.0), (80.0, 14.0), FRAME, &hatch, &[]);
        assert!(FRAME.contains(&area), "{area:?}");
    }
}
