//! The scenario files of the paper are right and ask for what the paper reports.

use std::path::Path;

use lashloop_bench::scenario::Scenario;

/// (file, law, plant has dry friction, metric, min, max)
#[expect(clippy::approx_constant, reason = "0.318 is the paper's static error less a tolerance, not 1/pi")]
const FILES: [(&str, &str, bool, &str, f64, f64); 4] = [
    ("smooth-before", "pd", false, "settle_time_s", 12.75, 13.05),
    ("smooth-after", "merzouki", false, "settle_time_s", 5.04, 5.24),
    ("friction-before", "pd", true, "static_error_rad", 0.318, 0.322),
    ("friction-after", "merzouki", true, "static_error_rad", -0.015, 0.015),
];

fn scenario(name: &str) -> Scenario {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../../scenarios/{name}.toml"));
    Scenario::from_file(&path, &[]).unwrap_or_else(|errors| panic!("{errors}"))
}

#[test]
fn each_file_asks_for_the_figure_of_the_paper() {
    for (name, law, friction, metric, min, max) in FILES {
        let scenario = scenario(name);
        assert_eq!(scenario.controller.name, law, "{name}");
        assert_eq!(scenario.plant.number("load_coulomb_nm").is_some(), friction, "{name}");
        let expectation = &scenario.expectations[0];
        assert_eq!(expectation.quantity.to_string(), metric, "{name}");
        assert_eq!((expectation.min, expectation.max), (Some(min), Some(max)), "{name}");
        assert_eq!(scenario.run.steps(), 25_000, "{name}");
    }
}

#[test]
fn before_and_after_differ_in_the_law_only() {
    for (before, after) in [("smooth-before", "smooth-after"), ("friction-before", "friction-after")] {
        let (before, after) = (scenario(before), scenario(after));
        assert_eq!(before.plant, after.plant);
        assert_eq!(before.run, after.run);
        assert_eq!(before.reference, after.reference);
        assert_eq!(before.encoders, after.encoders);
    }
}
