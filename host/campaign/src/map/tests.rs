use super::*;
use crate::axis::{Axis, AxisValue, Range, Scale, Values};

const LIMIT: Limit = Limit::Max(3.0);
const NEVER: Cell = Cell::Missing(Missing::Never);

fn axis(key: &str, values: &[f64]) -> Axis {
    let values = values.iter().copied().map(AxisValue::Number).collect();
    let keys = vec![key.to_owned()];
    Axis { keys, label: None, unit: "us".to_owned(), values: Values::Listed(values), times: None }
}

fn grid(axes: Vec<Axis>, most_cells: usize, cell: impl Fn(u64) -> Cell) -> Grid {
    let part = Part {
        name: "map".to_owned(),
        set: Vec::new(),
        method: Method::Grid,
        points: None,
        axes_of: None,
        axes,
    };
    let rows = part.axes.iter().map(|axis| axis.values.len()).product();
    let mut grid = Grid::of(&part, most_cells).expect("a grid");
    (0..rows).for_each(|row| grid.push(row, cell(row)));
    grid
}

/// Delay 0, 10, 30 and jitter 0, 20; the value is delay/10 + jitter/10.
fn plane() -> Grid {
    let axes = vec![axis("delay", &[0.0, 10.0, 30.0]), axis("jitter", &[0.0, 20.0])];
    grid(axes, usize::MAX, |row| {
        let (delay, jitter) = ([0.0, 1.0, 3.0][row as usize / 2], [0.0, 2.0][row as usize % 2]);
        Cell::Value(delay + jitter)
    })
}

fn square(cells: [Cell; 4]) -> Map {
    // In the order of rows: the second pair is that of the second tick of y.
    Map { width: 2, cells: cells.map(Some).to_vec() }
}

#[test]
fn iso_line_of_a_plane_is_where_the_plane_has_the_limit() {
    let map = plane().map([0, 1], &[None, None], Over::Worst);
    assert_eq!(
        map.cells.iter().map(|cell| cell.and_then(Cell::value)).collect::<Vec<_>>(),
        [Some(0.0), Some(1.0), Some(3.0), Some(2.0), Some(3.0), Some(5.0)]
    );
    // delay + jitter = 25: from delay 5 at jitter 20 to delay 25 at jitter 0, in ticks 0.5 and 1.75.
    let limit = Limit::Max(2.5);
    let mut ends: Vec<_> = map.iso_lines(limit).concat();
    assert_eq!(ends.len(), 4, "one segment in each square");
    ends.sort_by(|a, b| a[0].total_cmp(&b[0]));
    assert_eq!([ends[0], ends[3]], [[0.5, 1.0], [1.75, 0.0]]);
    assert_eq!([ends[1], ends[2]], [[1.0, 0.75]; 2], "the segments meet on the common edge");
}

#[test]
fn point_is_interpolated_between_the_cells_that_enclose_it() {
    let grid = plane();
    let value = |point: [f64; 2]| grid.place(&point, LIMIT).expect("a place").value.value().expect("a value");
    assert_eq!([[0.0, 0.0], [5.0, 10.0], [20.0, 0.0], [30.0, 20.0]].map(value), [0.0, 1.5, 2.0, 5.0]);
    let side = |point: [f64; 2], limit| grid.place(&point, limit).expect("a place").side;
    assert_eq!(side([10.0, 20.0], LIMIT), Side::Inside);
    assert_eq!(side([10.0, 20.0], Limit::Below(3.0)), Side::Outside);
    assert_eq!(side([10.2, 20.0], LIMIT), Side::Outside);
    let beyond = grid.place(&[31.0, 0.0], LIMIT).expect_err("outside the map").to_string();
    assert!(beyond.contains("delay of 31 us is outside the map, 0 to 30 us"), "{beyond}");
    assert!(grid.place(&[1.0], LIMIT).is_err());
}

#[test]
fn cell_without_a_value_is_outside_and_halfway_to_it_is_the_edge() {
    let grid = grid(vec![axis("delay", &[0.0, 10.0]), axis("jitter", &[0.0, 10.0])], usize::MAX, |row| {
        if row < 2 { Cell::Value(1.0) } else { NEVER }
    });
    let lines = grid.map([0, 1], &[None, None], Over::Mean).iso_lines(LIMIT);
    assert_eq!(lines, [[[0.5, 0.0], [0.5, 1.0]]]);
    let place = |delay| grid.place(&[delay, 3.0], LIMIT).expect("a place");
    assert_eq!([0.0, 4.0, 10.0].map(|delay| place(delay).side), [Side::Inside, Side::Edge, Side::Outside]);
    assert_eq!([place(0.0).value, place(4.0).value], [Cell::Value(1.0), NEVER]);
}

#[test]
fn middle_of_a_saddle_joins_the_corners_on_its_side() {
    let (low, high) = (Cell::Value(0.0), Cell::Value(4.0));
    let around = |line: Segment, corner: [f64; 2]| {
        line.iter().all(|end| (end[0] - corner[0]).abs() + (end[1] - corner[1]).abs() < 1.0)
    };
    // The middle is 2: below 3 it joins the low corners, so the lines are around the high ones; above 1 the other way.
    for (limit, corners) in [(3.0, [[1.0, 0.0], [0.0, 1.0]]), (1.0, [[0.0, 0.0], [1.0, 1.0]])] {
        let lines = square([low, high, high, low]).iso_lines(Limit::Max(limit));
        assert_eq!(lines.len(), 2);
        for corner in corners {
            assert!(lines.iter().any(|line| around(*line, corner)), "limit {limit}: {lines:?}");
        }
    }
    assert_eq!(square([low, high, high, NEVER]).iso_lines(Limit::Max(3.0)).len(), 1);
}

#[test]
fn further_axes_are_cut_or_reduced_to_their_worst_or_mean() {
    let axes = || vec![axis("a", &[0.0, 1.0]), axis("b", &[0.0, 1.0, 2.0]), axis("c", &[0.0, 1.0])];
    let grid = grid(axes(), usize::MAX, |row| if row == 11 { NEVER } else { Cell::Value(row as f64) });
    let cells = |slice: Option<usize>, over| grid.map([2, 0], &[None, slice, None], over).cells;
    let values = |values: [f64; 4]| values.map(|value| Some(Cell::Value(value))).to_vec();
    assert_eq!(cells(Some(1), Over::Mean), values([2.0, 3.0, 8.0, 9.0]));
    assert_eq!(cells(None, Over::Worst)[..3], values([4.0, 5.0, 10.0, 0.0])[..3]);
    assert_eq!(cells(None, Over::Mean)[..3], values([2.0, 3.0, 8.0, 0.0])[..3]);
    assert_eq!([Over::Worst, Over::Mean].map(|over| cells(None, over)[3]), [Some(NEVER); 2]);
}

#[test]
fn omitted_runs_do_not_count_in_a_cell_unless_all_are_omitted() {
    const OMITTED: Cell = Cell::Missing(Missing::Omitted);
    let reduced = |cells: [Cell; 2]| {
        let mut runs = Runs::default();
        cells.into_iter().for_each(|cell| runs.push(cell));
        [Over::Worst, Over::Mean].map(|over| runs.reduced(over))
    };
    let one = [Some(Cell::Value(1.0)); 2];
    assert_eq!(reduced([OMITTED, Cell::Value(1.0)]), one);
    assert_eq!(reduced([Cell::Value(1.0), OMITTED]), one);
    assert_eq!(reduced([OMITTED; 2]), [Some(OMITTED); 2]);
}

#[test]
fn long_axes_are_coarsened_until_the_cells_suffice() {
    let range = Range { min: 0.0, max: 999.0, scale: Scale::Whole, points: Some(1000) };
    let long = Axis { values: Values::Range(range), ..axis("long", &[]) };
    let grid = grid(vec![long, axis("short", &[0.0, 1.0])], 100, |row| Cell::Value(row as f64));
    assert!(grid.cells.len() <= 100, "{}", grid.cells.len());
    let map = grid.map([0, 1], &[None, None], Over::Worst);
    let last = |tick: usize| grid.axes[0].ticks[tick][1].number().expect("a number");
    assert_eq!(last(map.width - 1), 999.0);
    // Row 2 n + 1 is value n of the long axis and the second of the short one.
    let second_row: Vec<_> = map.cells[map.width..].iter().map(|cell| cell.and_then(Cell::value)).collect();
    assert_eq!(second_row, (0..map.width).map(|tick| Some(2.0 * last(tick) + 1.0)).collect::<Vec<_>>());
}
