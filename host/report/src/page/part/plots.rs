//! Places of the charts and the controls of their range of time.

use maud::{Markup, html};

use super::super::data::{Chart, Data, Part, TRAIL_GROUP};

/// Controls of all charts; they stay in view.
pub(in super::super) fn controls() -> Markup {
    html! {
        div.controls role="toolbar" aria-label="Range of time" hidden {
            button type="button" data-do="out" title="Zoom out (-)" aria-label="Zoom out" { "\u{2212}" }
            button type="button" data-do="in" title="Zoom in (+)" aria-label="Zoom in" { "+" }
            label { "from " input type="text" inputmode="decimal" data-edge="0" size="8"; }
            label { "to " input type="text" inputmode="decimal" data-edge="1" size="8"; " s" }
            button type="button" data-do="reset" title="Whole range (Escape)" { "Whole range" }
            output.cursor-time aria-label="Time at the cursor" {}
        }
    }
}

/// The charts of a part.
pub(in super::super) fn charts(data: &Data, part: Part) -> Markup {
    html! {
        div.charts { @for (number, chart) in data.charts.iter().enumerate() {
            @if chart.part == part { (place(number, chart)) }
        } }
    }
}

fn place(number: usize, chart: &Chart) -> Markup {
    html! { figure data-chart=(number) { noscript { (chart.title) ": needs JavaScript." } } }
}

/// Whether a part has a chart.
pub(in super::super) fn has(data: &Data, part: Part) -> bool {
    data.charts.iter().any(|chart| chart.part == part)
}

/// What a reader must know of the curves, and how to use them.
pub(in super::super) fn note(data: &Data) -> Markup {
    html! {
        p.note #chart-keys {
            "Drag to zoom, Shift and drag to pan, Ctrl and wheel to zoom, double click for the whole range. On a focused chart the arrow keys \
             move the cursor, with Shift they pan; + and \u{2212} zoom, Home and End go to the ends, Escape shows the whole range. "
            "Curves are rounded to 1/" (data.steps) " of their range"
            @match data.thinned() {
                Some(steps) => {
                    "; of each " (steps) " steps they have the smallest and the largest value. Phase plane and hysteresis have the steps with the \
                     smallest and the largest value of either axis, of each " (steps * TRAIL_GROUP) " steps. "
                }
                None => "; every step is there. ",
            }
            "The record has all digits."
        }
    }
}
