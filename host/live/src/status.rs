//! The state of a run as the page shows it. Numbers that only a person reads are texts.

use lashloop_bench::number::{Apart, Shown};
use lashloop_bench::timing::{Quantiles, TimingReport};
use lashloop_bench::verdict::{JudgedExpectation, Verdict};
use serde::Serialize;

use super::standing::{SoFar, Standing};

/// A run at one moment.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Status {
    kind: &'static str,
    steps: u64,
    simulated_s: f64,
    /// Simulated time per wall-clock time.
    rate: f64,
    /// The verdict, once no step can improve it.
    decided: Option<Verdict>,
    phrase: String,
    expectations: Vec<Line>,
    breaches: Vec<String>,
    unanswered: u64,
    missed: u64,
    quantiles_us: Vec<(&'static str, Quantiles)>,
}

/// One expectation.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct Line {
    quantity: String,
    window: String,
    value: String,
    bounds: String,
    standing: Standing,
}

impl Status {
    /// The state after `steps` steps.
    #[must_use]
    pub fn new(so_far: &SoFar, timing: &TimingReport, steps: u64, simulated_s: f64, rate: f64) -> Self {
        let quantiles = [("lateness", timing.lateness_us), ("round trip", timing.round_trip_us)];
        Self {
            kind: "status",
            steps,
            simulated_s,
            rate,
            decided: so_far.decided(),
            phrase: so_far.to_string(),
            expectations: so_far.rows.iter().map(|row| Line::new(&row.judged, row.standing)).collect(),
            breaches: so_far.breaches.iter().map(ToString::to_string).collect(),
            unanswered: timing.unanswered,
            missed: timing.missed,
            quantiles_us: quantiles
                .into_iter()
                .filter_map(|(name, quantiles)| Some((name, quantiles?)))
                .collect(),
        }
    }
}

impl Line {
    fn new(judged: &JudgedExpectation, standing: Standing) -> Self {
        let JudgedExpectation { quantity, window, value, unit, min, max, .. } = judged;
        let value = match value.value() {
            Some(value) => format!("{} {unit}", Apart::new(value, *min, *max)),
            None => value.to_string(),
        };
        let bounds = match (min, max) {
            (Some(min), Some(max)) => format!("{} to {} {unit}", Shown(*min), Shown(*max)),
            (Some(min), None) => format!("at least {} {unit}", Shown(*min)),
            (None, Some(max)) => format!("at most {} {unit}", Shown(*max)),
            (None, None) => String::new(),
        };
        let window = window.map_or_else(String::new, |window| window.to_string());
        Self { quantity: quantity.to_string(), window, value, bounds, standing }
    }
}

/// The end of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Ending {
    kind: &'static str,
    /// `complete`, or what interrupted the run.
    end: String,
    verdict: Verdict,
    expectations: Vec<Line>,
    /// Why the verdict is not PASS.
    reasons: Vec<String>,
    /// The folder of the record, if there is one.
    record: Option<String>,
}

impl Ending {
    /// The end of a judged run.
    #[must_use]
    pub fn new(outcome: &lashloop_bench::run::Outcome, record: Option<&std::path::Path>) -> Self {
        let judgement = &outcome.judgement;
        let standing = |ok| if ok { Standing::Met } else { Standing::Missed };
        Self {
            kind: "end",
            end: outcome.end.to_string(),
            verdict: judgement.verdict,
            expectations: judgement.expectations.iter().map(|it| Line::new(it, standing(it.ok))).collect(),
            reasons: outcome.reasons(),
            record: record.map(|folder| folder.display().to_string()),
        }
    }
}

#[cfg(test)]
mod tests {
    use lashloop_bench::run::{End, Outcome};
    use lashloop_bench::timing::{ClockName, Timings};
    use lashloop_bench::verdict::{Breach, Judgement, LinkCounts};
    use lashloop_plant::metrics::{Measurement, SignalTable};

    use super::*;

    fn outcome(verdict: Verdict, end: End, breaches: Vec<Breach>) -> Outcome {
        let judgement = Judgement { verdict, expectations: Vec::new(), breaches, gate: None };
        Outcome {
            judgement,
            end,
            metrics: Measurement::new(1e-3, &SignalTable::default()).metrics(),
            link: LinkCounts::default(),
            timing: Timings::new(ClockName::Lockstep, 1_000, 0).report(Vec::new()),
            faults: Vec::new(),
            steps: 1,
            simulated_s: 1e-3,
            wall_s: 1e-3,
            torque_sha256: String::new(),
            logs: Vec::new(),
            signals: SignalTable::default(),
            scope: None,
        }
    }

    #[test]
    fn page_has_every_reason_of_the_verdict() {
        let breach = Breach { what: "late".into(), counted: Some(3), allowed: 0 };
        let mut closed = outcome(Verdict::Pass, End::Interrupted, vec![breach]);
        closed.judgement.close_gate("the model is of another plant".to_owned());
        let ending = Ending::new(&closed, None);
        assert_eq!(ending.verdict, Verdict::Invalid, "a closed gate leaves no verdict on the drive");
        let reasons =
            ["interrupted by the user", "the model is of another plant", "late: 3 counted, allow.late is 0"];
        assert_eq!(ending.reasons, reasons);
        let not_finite = outcome(Verdict::Fail, End::Complete, Vec::new());
        assert_eq!(Ending::new(&not_finite, None).reasons, ["a value of the run is not finite"]);
        let passed = outcome(Verdict::Pass, End::Complete, Vec::new());
        assert!(Ending::new(&passed, None).reasons.is_empty());
    }
}
