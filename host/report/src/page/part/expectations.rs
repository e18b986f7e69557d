//! The expectations of a run: value, limits, margin.

use lashloop_bench::verdict::JudgedExpectation;
use lashloop_campaign::suite::check::Check;
use maud::{Markup, html};

use super::super::margin::Margin;
use super::super::typeset::{self, apart, percent, shown};
use super::super::why::Tone;

pub(in super::super) fn section(expectations: &[JudgedExpectation]) -> Markup {
    html! {
        section #expectations {
            h2 { "Expectations" }
            @if expectations.is_empty() {
                p { "The scenario has no expectation." }
            } @else {
                div.scroll { table.expectations.stacked {
                    thead { tr {
                        th scope="col" { "quantity" } th scope="col" { "result" } th.number scope="col" { "value" }
                        th.number scope="col" { "limits" } th.number scope="col" { "margin" } th scope="col" { "place between the limits" }
                    } }
                    tbody { @for expectation in expectations { (row(expectation)) } }
                } }
                p.note { "Marginal: met with a margin below 10 % of the limit, or of the distance between two limits." }
            }
        }
    }
}

fn row(expectation: &JudgedExpectation) -> Markup {
    let check = Check::from(expectation);
    let tone = Tone::of_check(&check);
    let unit = &typeset::unit(&check.unit);
    html! {
        tr class=(tone.class()) {
            th scope="row" { (check.name) }
            td { span class={ "grade " (tone.class()) } { (tone.symbol()) " " (tone.class()) } }
            td.number data-label="value" { (judged(&check, expectation.reason.as_deref())) }
            td.number data-label="limits" { (limits(&check)) " " (unit) }
            td.number data-label="margin" { (margin(&check)) }
            td.gauge { (gauge(&check)) }
        }
    }
}

/// A rounded value, with all its digits for scripts and as a hint.
pub(in super::super) fn value(value: Option<f64>, unit: &str, reason: Option<&str>) -> Markup {
    match value {
        Some(value) => rounded(value, &shown(value), unit),
        None => html! { span.absent { (reason.unwrap_or("no value")) } },
    }
}

fn rounded(value: f64, text: &str, unit: &str) -> Markup {
    html! { data value=(value) title={ (value) " " (unit) } { (text) } " " (typeset::unit(unit)) }
}

/// The value of an expectation: it differs in print from a bound that it does not equal.
fn judged(check: &Check, reason: Option<&str>) -> Markup {
    let Check { value, unit, min, max, .. } = check;
    match value {
        Some(number) => rounded(*number, &apart(*number, *min, *max), unit),
        None => self::value(None, unit, reason),
    }
}

fn limits(check: &Check) -> String {
    match (check.min, check.max) {
        (Some(min), Some(max)) => format!("{} to {}", shown(min), shown(max)),
        (Some(min), None) => format!("\u{2265} {}", shown(min)),
        (None, Some(max)) => format!("\u{2264} {}", shown(max)),
        (None, None) => "none".to_owned(),
    }
}

fn margin(check: &Check) -> Markup {
    let Some(margin) = Margin::of_check(check) else { return html! { span.absent { "none" } } };
    html! {
        data value=(margin.distance) { (shown(margin.distance)) } " " (typeset::unit(&check.unit))
        @if let Some(fraction) = margin.fraction { " " small { "(" (percent(fraction)) ")" } }
    }
}

/// Range of the gauge, the part of it that passes, and the value's place, each as a fraction of the width.
fn places(check: &Check) -> Option<(f64, f64, f64)> {
    let value = check.value.filter(|value| value.is_finite())?;
    let (low, high) = match (check.min, check.max) {
        (Some(min), Some(max)) => (min - (max - min) * 0.25, max + (max - min) * 0.25),
        (Some(min), None) => {
            (min - min.abs().max(1e-12) * 0.5, min + min.abs().max(value - min).max(1e-12) * 1.2)
        }
        (None, Some(max)) => {
            let low = if max > 0.0 && value >= 0.0 {
                0.0
            } else {
                max - max.abs().max(max - value).max(1e-12) * 1.2
            };
            (low, max + max.abs().max(1e-12) * 0.25)
        }
        (None, None) => return None,
    };
    // Equal limits have no range to show.
    if !(high > low && (high - low).is_finite()) {
        return None;
    }
    let place = |value: f64| ((value - low) / (high - low)).clamp(0.0, 1.0);
    Some((place(check.min.unwrap_or(low)), place(check.max.unwrap_or(high)), place(value)))
}

fn gauge(check: &Check) -> Markup {
    let Some((from, to, at)) = places(check) else { return html! {} };
    let grade = Tone::of_check(check).class();
    let text = format!("{}: {grade}", check.name);
    html! {
        svg viewBox="0 0 120 14" role="img" aria-label=(text) {
            rect.track x="0" y="5" width="120" height="4" rx="2" {}
            rect.passing x=(format!("{:.1}", from * 120.0)) y="5" width=(format!("{:.1}", (to - from) * 120.0)) height="4" {}
            circle class=(grade) cx=(format!("{:.1}", 4.0 + at * 112.0)) cy="7" r="4" {}
        }
    }
}
