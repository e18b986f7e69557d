//! The truth lies within the intervals.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use lashloop_identify::excitation::{Commissioned, Limits, commission};

use lashloop_identify::{Direction, Start};

use crate::hidden::{HiddenPlant, PERIOD_US};

/// The constants of the estimator were chosen on seeds 0 to 149, the width of the intervals with them.
const SEEDS: std::ops::Range<u64> = 5000..5050;
const LIMITS: Limits =
    Limits { torque_nm: 20.0, motor_speed_rad_s: 400.0, load_speed_rad_s: 10.0, load_travel_rad: 1.5 };

/// Of one quantity, over all plants.
#[derive(Default)]
struct Tally {
    unit: &'static str,
    observed: usize,
    covered: usize,
    /// Half widths of the intervals relative to the truth.
    widths: Vec<f64>,
}

#[test]
fn truth_is_within_the_interval_on_nine_of_ten_hidden_plants() {
    let mut tallies = BTreeMap::<&str, Tally>::new();
    let mut followed = 0;
    for seed in SEEDS {
        let mut plant = HiddenPlant::draw(seed);
        let instruments = plant.instruments();
        let commissioned = commission(&mut plant, &instruments, &LIMITS, PERIOD_US, &Start::default());
        let Commissioned { identified, .. } =
            commissioned.unwrap_or_else(|error| panic!("seed {seed}: {error}"));
        let shown = [identified.directions.motor, identified.directions.load];
        assert_eq!(
            shown.map(|it| it.map(Direction::sign)),
            plant.signs.map(Some),
            "directions of seed {seed}"
        );
        followed += usize::from(identified.is_followed());
        for quantity in &identified.quantities {
            let tally = tallies.entry(quantity.name).or_default();
            tally.unit = quantity.unit;
            let Some(estimate) = quantity.estimate else { continue };
            let truth = plant.truth(quantity.name);
            tally.observed += 1;
            tally.covered += usize::from((estimate.low..=estimate.high).contains(&truth));
            // The asymmetry may be zero.
            let scale = if quantity.name == "load_friction_asymmetry" { 1.0 } else { truth };
            tally.widths.push(0.5 * (estimate.high - estimate.low) / scale);
        }
    }
    let plants = SEEDS.count();
    report(&tallies, plants, followed);
    let missed: Vec<_> = tallies
        .iter()
        .filter(|(_, it)| 10 * it.covered < 9 * it.observed || 2 * it.observed < plants)
        .map(|(name, it)| format!("{name}: {} of {} intervals, {plants} plants", it.covered, it.observed))
        .collect();
    assert!(
        missed.is_empty(),
        "truth outside the interval, or not observed, too often:\n{}",
        missed.join("\n")
    );
    assert!(10 * followed >= 9 * plants, "the model follows {followed} of {plants} plants");
}

/// Writes coverage and median width of each quantity.
fn report(tallies: &BTreeMap<&str, Tally>, plants: usize, followed: usize) {
    let mut text = format!(
        "identification, {plants} hidden plants, {followed} followed to the quantisation: truth within the 95 % interval, \
         median half width\n"
    );
    for (name, Tally { observed, covered, widths, .. }) in tallies {
        let mut widths = widths.clone();
        widths.sort_by(f64::total_cmp);
        let median = widths.get(widths.len() / 2).map_or(f64::NAN, |width| 100.0 * width);
        writeln!(text, "  {name:<26} {covered:>3} of {observed:<3} {median:>9.4} %").expect("a string");
    }
    print!("{text}");
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).with_file_name("reports");
    let written =
        fs::create_dir_all(&folder).and_then(|()| fs::write(folder.join("identification.txt"), text));
    written.expect("a folder for reports");
}
