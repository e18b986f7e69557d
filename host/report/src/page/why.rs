//! The verdict of a run and its reason in one sentence.

use lashloop_bench::verdict::{Breach, JudgedExpectation, Verdict};
use lashloop_campaign::suite::check::Check;
use lashloop_record::summary::{RunEnd, Summary};

use super::input::Run;
use super::margin::Margin;
use super::typeset::{self, apart, percent, shown};

/// Below this fraction a margin is marginal: of the bound, or of the width between two bounds.
const MARGINAL: f64 = 0.1;

/// What a page shows as the verdict of a run or of one expectation. The name is a class of the style, too.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Tone {
    Pass,
    /// PASS with a marginal expectation, or an expectation met with a marginal margin.
    Marginal,
    Fail,
    Invalid,
    /// No verdict.
    None,
}

impl Tone {
    pub(super) fn of(run: &Run) -> Self {
        let Some(summary) = &run.record.summary else { return Self::None };
        let mut tones = summary.expectations.iter().map(|it| Self::of_check(&Check::from(it)));
        match Self::of_verdict(summary.verdict) {
            Self::Pass if tones.any(|it| it == Self::Marginal) => Self::Marginal,
            tone => tone,
        }
    }

    /// Of a verdict alone.
    pub(super) fn of_verdict(verdict: Verdict) -> Self {
        match verdict {
            Verdict::Pass => Self::Pass,
            Verdict::Fail => Self::Fail,
            Verdict::Invalid => Self::Invalid,
        }
    }

    /// Of an expectation, or of a metric against its baseline.
    pub(super) fn of_check(check: &Check) -> Self {
        match Margin::of_check(check).and_then(|margin| margin.fraction) {
            _ if !check.ok => Self::Fail,
            Some(fraction) if fraction < MARGINAL => Self::Marginal,
            _ => Self::Pass,
        }
    }

    /// A sign in addition to the colour.
    pub(super) fn symbol(self) -> &'static str {
        match self {
            Self::Pass => "\u{2713}",
            Self::Marginal => "\u{25b3}",
            Self::Fail | Self::Invalid | Self::None => "\u{2715}",
        }
    }

    pub(super) fn class(self) -> &'static str {
        match self {
            Self::Pass => "pass",
            Self::Marginal => "marginal",
            Self::Fail => "fail",
            Self::Invalid => "invalid",
            Self::None => "none",
        }
    }
}

/// PASS, FAIL, INVALID, or that there is none.
pub(super) fn verdict(run: &Run) -> String {
    let summary = run.record.summary.as_ref();
    summary.map_or_else(|| "NO VERDICT".to_owned(), |summary| summary.verdict.to_string())
}

/// Why the verdict is what it is.
pub(super) fn sentence(run: &Run) -> String {
    let Some(summary) = &run.record.summary else {
        let end_s = run.times_s().last().copied().unwrap_or(0.0);
        if let Some(failure) = &run.record.failure {
            return format!("The run failed at {end_s:.3} s: {}.", failure.error.trim_end_matches('.'));
        }
        return format!("The run was interrupted: the record ends at {end_s:.3} s without a summary.");
    };
    if let Some(gate) = &summary.gate {
        return gate.clone();
    }
    match (summary.verdict, &summary.end) {
        (Verdict::Pass, _) => passed(summary),
        (_, RunEnd::Early(end)) => format!("The run ended at {:.3} s: {end}.", summary.simulated_s),
        (Verdict::Invalid, RunEnd::Complete) => invalid(summary),
        (Verdict::Fail, RunEnd::Complete) => failed(summary),
    }
}

fn passed(summary: &Summary) -> String {
    let checks: Vec<_> = summary.expectations.iter().map(Check::from).collect();
    let count = checks.len();
    let met = match count {
        0 => {
            return "Nothing was expected: the scenario has no expectation. Every value of the run is finite."
                .to_owned();
        }
        1 => "The expectation is met".to_owned(),
        _ => format!("All {count} expectations are met"),
    };
    let marginal = checks.iter().filter(|it| Tone::of_check(it) == Tone::Marginal).count();
    let marginal = if marginal == 0 { String::new() } else { format!(", {marginal} of them marginally") };
    let graded = checks.iter().filter_map(|it| Some((&it.name, Margin::of_check(it)?.fraction?)));
    match graded.min_by(|(_, a), (_, b)| a.total_cmp(b)) {
        Some((least, fraction)) => {
            format!("{met}{marginal}; the smallest margin is {} of {least}.", percent(fraction))
        }
        None => format!("{met}{marginal}."),
    }
}

fn failed(summary: &Summary) -> String {
    let missed: Vec<_> = summary.expectations.iter().filter(|it| !it.ok).collect();
    let Some((first, others)) = missed.split_first() else {
        return "A value of the run is not finite.".to_owned();
    };
    let rest = match others.len() {
        0 => String::new(),
        more => format!("; {more} more of {} expectations missed", summary.expectations.len()),
    };
    format!("{}{rest}.", departure(first))
}

/// How an expectation is missed.
fn departure(missed: &JudgedExpectation) -> String {
    let (name, unit) = (missed.name(), typeset::unit(&missed.unit));
    let Some(value) = missed.value.value() else {
        return format!("{name} has no value: {}", missed.reason.as_deref().unwrap_or_default());
    };
    let side = match (missed.min, missed.max) {
        (Some(min), _) if value < min => format!("below the limit of {}", shown(min)),
        (_, Some(max)) => format!("above the limit of {}", shown(max)),
        _ => "outside its limits".to_owned(),
    };
    format!("{name} is {} {unit}, {side} {unit}", apart(value, missed.min, missed.max))
}

fn invalid(summary: &Summary) -> String {
    let Some((Breach { what, counted, allowed }, others)) = summary.breaches.split_first() else {
        return "Link or timing exceeded what the scenario allows, so the run proves nothing about the drive."
            .to_owned();
    };
    let rest =
        if others.is_empty() { String::new() } else { format!("; {} more limits exceeded", others.len()) };
    match counted {
        Some(counted) => format!(
            "{what} is {counted}, allow.{what} is {allowed}{rest}: the run proves nothing about the drive."
        ),
        None => format!("{what} has nothing to measure, allow.{what} is {allowed}{rest}."),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tone(value: Option<f64>, min: Option<f64>, max: Option<f64>) -> Tone {
        let ok = value.is_some_and(|it| min.is_none_or(|min| it >= min) && max.is_none_or(|max| it <= max));
        Tone::of_check(&Check { name: String::new(), value, min, max, unit: String::new(), ok })
    }

    #[test]
    fn a_margin_below_a_tenth_of_the_bound_is_marginal() {
        for (value, min, max, want) in [
            (Some(5.0), None, Some(6.0), Tone::Pass),
            (Some(5.5), None, Some(6.0), Tone::Marginal),
            (Some(6.0), None, Some(6.0), Tone::Marginal),
            (Some(6.1), None, Some(6.0), Tone::Fail),
            (Some(5.2), Some(5.0), Some(6.0), Tone::Pass),
            (Some(5.95), Some(5.0), Some(6.0), Tone::Marginal),
            (Some(-2.0), Some(-2.1), None, Tone::Marginal),
            (Some(0.5), Some(0.0), None, Tone::Pass),
            (None, None, Some(6.0), Tone::Fail),
        ] {
            assert_eq!(tone(value, min, max), want, "{value:?} in {min:?} to {max:?}");
        }
    }
}
