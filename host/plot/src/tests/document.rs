//! Curves, scales and text of any figure.

use roxmltree::{Document, Node};

use super::{SAMPLES, noise, texts, times};
use crate::{Axis, Figure, Panel, Role, Series};

fn panel(series: impl IntoIterator<Item = Series>) -> Panel {
    let panel = Panel::new("panel", Axis::new("time", "s"), Axis::new("torque", "N m"));
    series.into_iter().fold(panel, Panel::series)
}

fn svg_of(series: impl IntoIterator<Item = Series>) -> String {
    Figure::new("title", "caption", 1).panel(panel(series)).to_svg()
}

fn series(x: Vec<f64>, y: Vec<f64>) -> Series {
    Series::new("curve", Role::After, x, y)
}

/// The curves of a document: the paths that carry a name.
fn curves<'a>(document: &'a Document) -> Vec<Node<'a, 'a>> {
    let is_curve =
        |node: &Node| node.has_tag_name("path") && node.children().any(|child| child.has_tag_name("title"));
    document.descendants().filter(is_curve).collect()
}

/// Strokes of a path as absolute points.
fn strokes(path: Node) -> Vec<Vec<(f64, f64)>> {
    let data = path.attribute("d").expect("a path has data").replace('-', " -").replace("h0", "");
    data.split('M')
        .skip(1)
        .map(|stroke| {
            let mut at = (0.0, 0.0);
            stroke
                .split('l')
                .map(|pair| {
                    let mut numbers =
                        pair.split_whitespace().map(|number| number.parse::<f64>().expect("a number"));
                    at.0 += numbers.next().expect("x");
                    at.1 += numbers.next().expect("y");
                    assert_eq!(numbers.next(), None, "{pair}");
                    at
                })
                .collect()
        })
        .collect()
}

#[test]
fn peak_of_one_sample_survives_thinning() {
    let mut torque: Vec<f64> = (0..SAMPLES).map(|sample| 0.01 * noise(sample)).collect();
    torque[12_345] = 8.0;
    torque[12_347] = -8.0;
    let svg = svg_of([series(times(), torque)]);
    let document = Document::parse(&svg).expect("valid XML");
    let points = strokes(curves(&document)[0]).concat();
    assert!(points.len() < 4_000, "{} points", points.len());
    let (top, bottom) = points
        .iter()
        .fold((f64::MAX, f64::MIN), |(top, bottom), point| (point.1.min(top), point.1.max(bottom)));
    let calm = points[0].1;
    // The axis runs from -10 to 10 over 320 px, hence 16 px for 1 N m.
    assert!((calm - top - 128.0).abs() < 0.5 && (bottom - calm - 128.0).abs() < 0.5, "{top} {calm} {bottom}");
}

#[test]
fn non_finite_values_break_the_curve_and_not_the_scale() {
    let y = vec![0.0, 1.0, f64::NAN, 1.0, 0.0, f64::INFINITY, 0.5];
    let svg = svg_of([series((0..7).map(f64::from).collect(), y)]);
    assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    let document = Document::parse(&svg).expect("valid XML");
    let lengths: Vec<usize> = strokes(curves(&document)[0]).iter().map(Vec::len).collect();
    assert_eq!(lengths, [2, 2, 1]);
    assert!(
        texts(&document).contains(&"1.0") && !texts(&document).contains(&"1.2"),
        "{:?}",
        texts(&document)
    );
}

#[test]
fn panel_without_values_states_no_data() {
    for empty in [vec![], vec![series(vec![], vec![])], vec![series(vec![0.0, 1.0], vec![f64::NAN; 2])]] {
        let svg = svg_of(empty);
        let document = Document::parse(&svg).expect("valid XML");
        assert!(texts(&document).contains(&"no data"));
        assert!(curves(&document).is_empty());
    }
    let svg = Figure::new("nothing at all", "", 0).to_svg();
    Document::parse(&svg).expect("valid XML");
}

#[test]
fn band_sets_the_scale_of_a_constant_zero() {
    let svg = Figure::new("title", "caption", 1)
        .panel(panel([series(vec![0.0, 1.0], vec![0.0; 2])]).band("settled", -0.05, 0.05))
        .to_svg();
    let document = Document::parse(&svg).expect("valid XML");
    assert!(
        texts(&document).contains(&"0.04") && !texts(&document).contains(&"0.5"),
        "{:?}",
        texts(&document)
    );
}

#[test]
fn deviation_is_shaded_around_the_curve_and_within_the_scale() {
    let y = vec![0.0, 0.0, f64::NAN, 0.0, 0.0];
    let shaded = series((0..5).map(f64::from).collect(), y).deviation(vec![10.0, 5.0, 5.0, 5.0, 10.0]);
    let svg = svg_of([shaded.clone()]);
    let document = Document::parse(&svg).expect("valid XML");
    assert!(texts(&document).contains(&"10"), "{:?}", texts(&document));
    let shades: Vec<_> = document.descendants().filter(|node| node.has_attribute("fill-opacity")).collect();
    assert_eq!(shades.len(), 3, "one in the legend, one on each side of the missing value");
    assert!(svg_of([series(shaded.x, shaded.y)]).find("fill-opacity").is_none());
}

#[test]
fn constant_curve_lies_inside_the_plot() {
    for value in [0.0, 0.16, -1e12, 1e-320, 1e299] {
        let svg = svg_of([series(vec![0.0, 1.0], vec![value; 2])]);
        let document = Document::parse(&svg).expect("valid XML");
        let labels = texts(&document).len();
        assert!((8..30).contains(&labels), "{labels} texts for {value}");
        let points = strokes(curves(&document)[0]).concat();
        let height: f64 =
            document.root_element().attribute("height").and_then(|text| text.parse().ok()).expect("height");
        assert!(
            points.iter().all(|point| point.1 > 60.0 && point.1 < height - 60.0),
            "{points:?} for {value}"
        );
    }
}

#[test]
fn text_is_escaped_and_parses_back_unchanged() {
    let hostile = "a < b && \"c\" > 'd' </text><script>";
    let figure = Figure::new(hostile, hostile, 1).panel(
        Panel::new(hostile, Axis::new(hostile, ""), Axis::new(hostile, ""))
            .series(Series::new(hostile, Role::Before, vec![0.0, 1.0], vec![0.0, 1.0]))
            .band(hostile, 0.0, 0.1)
            .mark(hostile, Role::Limit, 0.5, 0.5),
    );
    let svg = figure.to_svg();
    let document = Document::parse(&svg).expect("valid XML");
    assert!(!document.descendants().any(|node| node.has_tag_name("script")));
    assert_eq!(texts(&document).iter().filter(|text| **text == hostile).count(), 8);
    let elements = document.descendants().filter(Node::is_element);
    assert_eq!(elements.filter(|node| node.text() == Some(hostile)).count(), 11);
    let control = svg_of([Series::new("nul \0, bell \u{7}", Role::Other(9), vec![0.0], vec![0.0])]);
    Document::parse(&control).expect("valid XML in spite of control characters");
}

#[test]
fn title_and_caption_are_accessible() {
    let svg = svg_of([]);
    let document = Document::parse(&svg).expect("valid XML");
    let root = document.root_element();
    let announced: Vec<_> = root
        .children()
        .filter(Node::is_element)
        .take(2)
        .map(|node| (node.tag_name().name(), node.text()))
        .collect();
    assert_eq!(root.attribute("role"), Some("img"));
    assert_eq!(announced, [("title", Some("title")), ("desc", Some("caption"))]);
}

#[test]
fn coordinates_of_large_values_share_a_power_of_ten_in_the_axis_name() {
    let svg = svg_of([series(vec![0.0, 1e7], vec![0.0, 4e-6])]);
    let document = Document::parse(&svg).expect("valid XML");
    assert!(texts(&document).contains(&"time (10⁷ s)"), "{:?}", texts(&document));
    assert!(texts(&document).contains(&"torque (10⁻⁶ N m)"), "{:?}", texts(&document));
}

#[test]
fn the_same_figure_gives_the_same_document() {
    let wave = [0.0, 0.8, 0.2, -0.1, 0.05];
    let figure = || {
        Figure::new("Step", "Two runs.", 2)
            .panel(
                panel([Series::new("pd", Role::Before, (0..5).map(f64::from).collect(), wave.to_vec())])
                    .band("settled", -0.1, 0.1)
                    .mark("3.0 s", Role::Before, 3.0, -0.1),
            )
            .panel(panel([Series::new("limit", Role::Limit, vec![0.0, 4.0], vec![1.0; 2])]))
    };
    assert_eq!(figure().to_svg(), figure().to_svg());
    insta::assert_snapshot!(figure().to_svg());
}

#[test]
fn equal_ratios_are_equal_lengths_on_a_logarithmic_axis_and_zero_breaks_the_curve() {
    let panel = Panel::new("panel", Axis::new("frequency", "Hz").logarithmic(), Axis::new("gain", ""));
    let curve = series(vec![0.1, 1.0, 10.0, 0.0, 1.0, 100.0], vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    let svg = Figure::new("title", "caption", 1).panel(panel.series(curve)).to_svg();
    let document = Document::parse(&svg).expect("valid XML");
    let strokes = strokes(curves(&document)[0]);
    let x: Vec<Vec<f64>> = strokes.iter().map(|it| it.iter().map(|point| point.0).collect()).collect();
    let (first, second) = (&x[0], &x[1]);
    let decade = first[1] - first[0];
    assert!(decade > 50.0 && (first[2] - first[1] - decade).abs() < 0.3, "{x:?}");
    assert!((second[1] - second[0] - 2.0 * decade).abs() < 0.3, "{x:?}");
    let texts = texts(&document);
    assert!(["0.1", "1", "10", "100"].iter().all(|label| texts.iter().any(|it| it == label)), "{texts:?}");
}
