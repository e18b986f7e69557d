//! The verdict of a run and its reason in one sentence.

use super::input::Run;
use super::margin::Grade;
use super::summary::{Breach, Expectation, Summary};
use super::typeset::{self, apart, percent, shown};

/// What a page shows as the verdict. The name is a class of the style, too.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Tone {
    Pass,
    /// PASS with a marginal expectation.
    Marginal,
    Fail,
    Invalid,
    /// No verdict.
    None,
}

impl Tone {
    pub(super) fn of(run: &Run) -> Self {
        let Some(summary) = &run.summary else { return Self::None };
        match Self::of_verdict(&summary.verdict) {
            Self::Pass if summary.expectations.iter().any(|it| it.grade() == Grade::Marginal) => {
                Self::Marginal
            }
            tone => tone,
        }
    }

    /// Of a verdict alone.
    pub(super) fn of_verdict(verdict: &str) -> Self {
        match verdict {
            "PASS" => Self::Pass,
            "FAIL" => Self::Fail,
            "INVALID" => Self::Invalid,
            _ => Self::None,
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
pub(super) fn verdict(run: &Run) -> &str {
    run.summary.as_ref().map_or("NO VERDICT", |summary| &summary.verdict)
}

/// Why the verdict is what it is.
pub(super) fn sentence(run: &Run) -> String {
    let Some(summary) = &run.summary else {
        let end_s = run.times_s().last().copied().unwrap_or(0.0);
        if let Some(failure) = &run.record.failure {
            return format!("The run failed at {end_s:.3} s: {}.", failure.error.trim_end_matches('.'));
        }
        return format!("The run was interrupted: the record ends at {end_s:.3} s without a summary.");
    };
    if let Some(gate) = &summary.gate {
        return gate.clone();
    }
    let early = (summary.end != "complete")
        .then(|| format!("The run ended at {:.3} s: {}.", summary.simulated_s, summary.end));
    match summary.verdict.as_str() {
        "PASS" => passed(summary),
        "INVALID" => early.unwrap_or_else(|| invalid(summary)),
        _ => early.unwrap_or_else(|| failed(summary)),
    }
}

fn passed(summary: &Summary) -> String {
    let count = summary.expectations.len();
    let met = match count {
        0 => return "The scenario has no expectation, and every value of the run is finite.".to_owned(),
        1 => "The expectation is met".to_owned(),
        _ => format!("All {count} expectations are met"),
    };
    let marginal = summary.expectations.iter().filter(|it| it.grade() == Grade::Marginal).count();
    let marginal = if marginal == 0 { String::new() } else { format!(", {marginal} of them marginally") };
    let graded = summary.expectations.iter().filter_map(|it| Some((it, it.margin()?.fraction?)));
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
fn departure(missed: &Expectation) -> String {
    let unit = typeset::unit(&missed.unit);
    let Some(value) = missed.value else {
        return format!(
            "{missed} has no value: {}",
            missed.reason.as_deref().unwrap_or("the reason is not recorded")
        );
    };
    let side = match (missed.min, missed.max) {
        (Some(min), _) if value < min => format!("below the limit of {}", shown(min)),
        (_, Some(max)) => format!("above the limit of {}", shown(max)),
        _ => "outside its limits".to_owned(),
    };
    format!("{missed} is {} {unit}, {side} {unit}", apart(value, missed.min, missed.max))
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
