//! Style and scripts of a page.

/// Charts: `LashloopCharts`, described at the head of `charts.js`.
pub const CHARTS: &str = concat!(
    include_str!("assets/scale.js"),
    include_str!("assets/gestures.js"),
    include_str!("assets/charts.js"),
);
/// Colours, tables and charts, light and dark, on screen and on paper.
pub const STYLE: &str = include_str!("assets/page.css");
/// The data of a report to charts and maps, and its controls.
pub(super) const REPORT: &str = concat!(include_str!("assets/maps.js"), include_str!("assets/report.js"));
