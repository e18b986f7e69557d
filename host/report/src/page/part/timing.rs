//! Timing of the steps: quantiles, histograms, the worst steps.

use lashloop_bench::timing::{ClockName, Quantiles, TimingReport};
use lashloop_record::timing::TimingRow;
use maud::{Markup, html};

use super::super::input::Run;
use super::super::typeset::shown;
use crate::steps::{parts_us, round_trip_us};

/// Worst steps that are listed.
const LISTED: usize = 10;

pub(in super::super) fn section(run: &Run) -> Markup {
    html! {
        @if let Some(summary) = &run.record.summary {
            p { (counts(&summary.timing)) }
            (quantiles(&summary.timing))
            div.histograms {
                (histogram("Lateness", &summary.timing.lateness_histogram))
                (histogram("Round trip", &summary.timing.round_trip_histogram))
            }
        }
        (worst(run))
    }
}

fn counts(timing: &TimingReport) -> String {
    let clock = match timing.clock {
        ClockName::Lockstep => {
            "Lockstep: plant and drive wait for each other, so timing changes no value of the run."
        }
        ClockName::RealTime => "Real time: each step starts at its due time.",
    };
    format!(
        "{clock} Period {} \u{b5}s; {} steps without an answer, {} missed, at most {} of these in a row; {} steps of warm-up excluded.",
        timing.period_us, timing.unanswered, timing.missed, timing.longest_run_of_late, timing.warm_up_steps
    )
}

fn quantiles(timing: &TimingReport) -> Markup {
    let rows = [
        ("lateness", timing.lateness_us),
        ("round trip", timing.round_trip_us),
        ("of this: sending", timing.send_us),
        ("line and device", timing.line_and_device_us),
        ("computing", timing.compute_us),
        ("receiving", timing.receive_us),
    ];
    let cells = |Quantiles { p50, p99, p99_9, max }| [p50, p99, p99_9, max];
    html! {
        div.scroll { table {
            thead { tr { th scope="col" { "time in \u{b5}s" } @for name in ["median", "99 %", "99.9 %", "largest"] { th.number scope="col" { (name) } } } }
            tbody { @for (name, quantiles) in rows {
                @if let Some(quantiles) = quantiles { tr {
                    th scope="row" { (name) }
                    @for value in cells(quantiles) { td.number { data value=(value) { (shown(value)) } } }
                } }
            } }
        } }
    }
}

/// Bars over bins whose upper ends double; lengths are logarithmic, because one late step in a million matters.
fn histogram(name: &str, bins: &[(f64, u64)]) -> Markup {
    let first = bins.iter().position(|(_, count)| *count > 0).unwrap_or(bins.len());
    let most = bins.iter().map(|(_, count)| *count).max().unwrap_or(0);
    let width = |count: u64| (1.0 + count as f64).ln() / (1.0 + most as f64).ln() * 100.0;
    html! {
        @if most > 0 {
            figure.histogram {
                figcaption { h3 { (name) } span { "steps, logarithmic" } }
                table { tbody { @for (end_us, count) in &bins[first..] { tr {
                    th.number scope="row" { "\u{2264} " (duration(*end_us)) }
                    td.bar { span style=(format!("width:{:.1}%", width(*count))) {} }
                    td.number { (count) }
                } } } }
            }
        }
    }
}

fn duration(us: f64) -> String {
    match us {
        _ if us < 1e3 => format!("{us:.0} \u{b5}s"),
        _ if us < 1e6 => format!("{} ms", shown(us / 1e3)),
        _ => format!("{} s", shown(us / 1e6)),
    }
}

/// Steps with their times: those without a torque first, then those with the longest time from their due time to their torque.
fn worst_of(run: &Run) -> Vec<(&TimingRow, f64)> {
    // A torque may lack its round trip: in bench mode there is none, after a retransmission it is not measured.
    let until_torque_us = |row: &TimingRow| match row.answered {
        0.0 => f64::INFINITY,
        _ => row.lateness_us + parts_us(row).into_iter().filter(|part_us| part_us.is_finite()).sum::<f64>(),
    };
    let mut rows: Vec<_> = run.timing.iter().zip(run.times_s().iter().copied()).collect();
    rows.sort_by(|(a, _), (b, _)| until_torque_us(b).total_cmp(&until_torque_us(a)));
    rows.truncate(LISTED);
    rows
}

fn worst(run: &Run) -> Markup {
    let rows = worst_of(run);
    let cell = |value: f64| {
        if value.is_finite() { shown(value) } else { "\u{2013}".to_owned() }
    };
    html! {
        @if rows.is_empty() {
            p { "The record has no timing of its steps." }
        } @else {
            h3 { "Worst steps" }
            div.scroll { table.worst {
                thead { tr {
                    @for name in ["step", "time in s", "lateness in \u{b5}s", "round trip in \u{b5}s", "sending", "line and device", "computing", "receiving"] {
                        th.number scope="col" { (name) }
                    }
                    th scope="col" { "answer" }
                } }
                tbody { @for (row, time_s) in rows { tr {
                    td.number { (row.step) }
                    td.number { button.jump type="button" data-time=(time_s) { (format!("{time_s:.3}")) } }
                    @for value in [row.lateness_us, round_trip_us(row), row.send_us, row.line_and_device_us, row.compute_us, row.receive_us] {
                        td.number { (cell(value)) }
                    }
                    td { (answer(row)) }
                } } }
            } }
        }
    }
}

fn answer(row: &TimingRow) -> &'static str {
    match (row.missed != 0.0, row.answered != 0.0) {
        (true, _) => "missed",
        (false, true) => "in time",
        (false, false) => "none in time",
    }
}
