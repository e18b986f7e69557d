//! The scenario of the unit tests.

use lashloop_bench::scenario::Scenario;

/// A scenario of 1 s with the given faults, each as the keys of a `[[fault]]` section.
pub(super) fn with_faults(faults: &[&str]) -> Scenario {
    let mut text =
        include_str!("../../../scenarios/shaft-pd.toml").replace("duration_s = 25.0", "duration_s = 1.0");
    for fault in faults {
        text += &format!("\n[[fault]]\n{fault}\n");
    }
    Scenario::from_str("x.toml", &text, &[]).unwrap_or_else(|errors| panic!("{errors}"))
}
