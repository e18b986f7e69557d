//! The scenario of the unit tests, and an outcome.

use lashloop_bench::run::{End, Outcome};
use lashloop_bench::scenario::Scenario;
use lashloop_bench::timing::{ClockName, Timings};
use lashloop_bench::verdict::{Judgement, LinkCounts, Verdict};
use lashloop_plant::metrics::{Measurement, SignalTable};

/// A scenario of 1 s with the given faults, each as the keys of a `[[fault]]` section.
pub(super) fn with_faults(faults: &[&str]) -> Scenario {
    // Without parameters: each carries its line in the file, which a round trip through TOML changes.
    let mut text = include_str!("../../../../scenarios/shaft-pd.toml")
        .replace("duration_s = 25.0", "duration_s = 1.0")
        .replace("torque_limit_nm = 20.0", "");
    for fault in faults {
        text += &format!("\n[[fault]]\n{fault}\n");
    }
    Scenario::from_str("x.toml", &text, &[]).unwrap_or_else(|errors| panic!("{errors}"))
}

/// A complete run of one step, without expectation, fault or signal.
pub(super) fn one_step(verdict: Verdict) -> Outcome {
    Outcome {
        judgement: Judgement { verdict, expectations: Vec::new(), breaches: Vec::new(), gate: None },
        end: End::Complete,
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
