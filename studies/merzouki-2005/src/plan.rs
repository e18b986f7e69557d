//! What the figures of the paper are drawn from: plants, each under three laws, and the plants at rest.

use lashloop_bench::run::simulator::Simulator;
use lashloop_bench::run::{Observation, RunError};
use lashloop_bench::scenario::{Override, Scenario, ScenarioErrors};
use lashloop_plant::metrics::SignalTable;
use lashloop_record::columns::Columns;
use lashloop_record::row::Row;
use lashloop_record::trace::columns;

use crate::scenarios::{SCENARIOS, Source};

/// The shaft under the three laws, then a slow sine under two of them.
pub const SHAFT: [Source; 5] = [
    ("scenarios/shaft-pd.toml", include_str!("../data/shaft-pd.toml")),
    ("scenarios/shaft-merzouki.toml", include_str!("../data/shaft-merzouki.toml")),
    ("scenarios/shaft-braking-curve.toml", include_str!("../data/shaft-braking-curve.toml")),
    ("scenarios/shaft-sine.toml", include_str!("../data/shaft-sine.toml")),
    ("scenarios/shaft-braking-curve-sine.toml", include_str!("../data/shaft-braking-curve-sine.toml")),
];

/// The expectations of a scenario hold for its own control law. That beyond the paper has these instead.
const EXPECTED_BEYOND: &str = r#"expect=[
    { metric = "settle_time_s", unit = "s", max = 1.3 },
    { metric = "overshoot_rad", unit = "rad", max = 0.005 },
]"#;
const WITHOUT_EXPECTATIONS: &str = "expect=[]";

const BEFORE: &str = "pd";
const BEYOND: &str = "braking-curve";

/// One plant under three laws: a scenario for each, and the law where it is not the scenario's.
pub type Plan = [(Source, Option<&'static str>); 3];

/// The plants of the figures, in the order of [`Runs`](crate::figures::Runs).
pub const PLANS: [Plan; 4] = [
    [(SCENARIOS[0], None), (SCENARIOS[1], None), (SCENARIOS[1], Some(BEYOND))],
    [(SCENARIOS[2], None), (SCENARIOS[3], None), (SCENARIOS[3], Some(BEYOND))],
    [(SHAFT[0], None), (SHAFT[1], None), (SHAFT[2], None)],
    [(SHAFT[3], Some(BEFORE)), (SHAFT[3], None), (SHAFT[4], None)],
];

/// Last period of the slow sine, which the figures show.
const SINE_SHOWN_S: f64 = 20.0;

/// Range and steps of the twist in figure 5.
const TWIST_RAD: f64 = 2.0;
const TWISTS: i32 = 400;

/// A scenario, under another law if one is given.
///
/// # Errors
/// The scenario doesn't fit the law.
pub fn scenario((name, text): Source, law: Option<&str>) -> Result<Scenario, ScenarioErrors> {
    let overrides = law.map(|law| {
        let expected = if law == BEYOND { EXPECTED_BEYOND } else { WITHOUT_EXPECTATIONS };
        [Override::Controller(law.to_owned()), Override::Set(expected.to_owned())]
    });
    Scenario::from_str(name, text, overrides.as_ref().map_or(&[], |overrides| overrides))
}

/// Start of the rows that the figures show: of a sine only the last period.
#[must_use]
pub fn shown_from_s(scenario: &Scenario) -> f64 {
    match scenario.reference.middle_rad() {
        Some(_) => f64::from(scenario.run.steps()) * scenario.run.control_period_s() - SINE_SHOWN_S,
        None => 0.0,
    }
}

/// The plant of a scenario at rest, at each twist in turn.
///
/// # Errors
/// The plant can't be built or integrated.
pub fn twist(mut scenario: Scenario) -> Result<Columns, RunError> {
    let mut trace: Option<Columns> = None;
    for step in -TWISTS..=TWISTS {
        let initial = &mut scenario.plant.initial;
        initial.load_position_rad = 0.0;
        initial.motor_position_rad = TWIST_RAD * f64::from(step) / f64::from(TWISTS);
        let mut simulator = Simulator::new(&scenario)?;
        let (_, Observation { row, plant }) = simulator.observe(0)?;
        let trace = trace.get_or_insert_with(|| {
            let signals = SignalTable { plant: simulator.signals().to_vec(), drive: Vec::new() };
            Columns::new(columns(&signals))
        });
        // No drive has sent telemetry, and none has taken a sample.
        trace.push(row.values().chain(plant).chain([f64::NAN; 4]));
    }
    Ok(trace.unwrap_or_default())
}
