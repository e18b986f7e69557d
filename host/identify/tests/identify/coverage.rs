//! The truth lies within the intervals.

use std::f64::consts::{PI, TAU};
use std::fs;
use std::ops::Range;
use std::path::Path;

use lashloop_identify::excitation::{Commissioned, Limits, commission};
use lashloop_identify::{Direction, Start};
use lashloop_plant::random::{Pcg64Mcg, SeedableRng as _, uniform};

use crate::hidden_plants::{Coverage, Errors, HiddenPlant, Shown};

/// The constants of the estimator were chosen on seeds 0 to 149, the width of the intervals with them.
const SEEDS: Range<u64> = 5000..5050;
/// Of plants with noise.
const NOISY_SEEDS: Range<u64> = 6000..6010;
const LIMITS: Limits =
    Limits { torque_nm: 20.0, motor_speed_rad_s: 400.0, load_speed_rad_s: 10.0, load_travel_rad: 1.5 };
/// Variable of the environment with other seeds, `FIRST..END`, for tuning.
const VARIABLE: &str = "LASHLOOP_HIDDEN_PLANTS";

fn seeds(default: Range<u64>) -> Range<u64> {
    let given = std::env::var(VARIABLE).ok();
    let parsed = given.as_deref().and_then(|text| {
        let (first, end) = text.split_once("..")?;
        Some(first.parse().ok()?..end.parse().ok()?)
    });
    assert_eq!(given.is_some(), parsed.is_some(), "{VARIABLE} is {given:?}; it must be FIRST..END");
    parsed.unwrap_or(default)
}

/// Commissions these plants.
fn coverage(seeds: Range<u64>, noise_counts: f64) -> Coverage {
    let mut coverage = Coverage::default();
    for seed in seeds {
        let mut plant = HiddenPlant::draw(seed).with_noise(noise_counts);
        let instruments = plant.instruments();
        let commissioned =
            commission(&mut plant, &instruments, &LIMITS, HiddenPlant::PERIOD_US, &Start::default());
        let Commissioned { identified, .. } =
            commissioned.unwrap_or_else(|error| panic!("seed {seed}: {error}"));
        let shown = [identified.directions.motor, identified.directions.load];
        let directions = shown.map(|it| it.map(Direction::sign));
        assert_eq!(directions, plant.signs.map(Some), "directions of seed {seed}");
        coverage.plant(identified.is_followed());
        for quantity in &identified.quantities {
            let truth = plant.truth(quantity.name);
            let shown = quantity.estimate.map(|it| Shown { low: it.low, high: it.high, truth });
            coverage.quantity(seed, quantity.name, shown);
        }
    }
    coverage
}

fn report(name: &str, text: &str) {
    print!("{text}");
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).with_file_name("reports");
    let written = fs::create_dir_all(&folder).and_then(|()| fs::write(folder.join(name), text));
    written.expect("a folder for reports");
}

fn assert_covered(coverage: &Coverage) {
    let missed = [coverage.missed(), coverage.unobserved()].concat();
    assert!(
        missed.is_empty(),
        "truth outside the interval, or not observed, too often:\n{}",
        missed.join("\n")
    );
}

#[test]
fn truth_is_within_the_interval_on_nine_of_ten_hidden_plants() {
    let coverage = coverage(seeds(SEEDS), 0.0);
    report("identification.txt", &format!("identification, {coverage}"));
    assert_covered(&coverage);
    assert!(coverage.follows(), "{coverage}");
}

/// Edges that jitter by up to 2 counts in either direction: a standard deviation of 1.2 counts, four times that of a count.
#[test]
fn truth_is_within_the_interval_with_noise_of_the_encoders() {
    let coverage = coverage(seeds(NOISY_SEEDS), 2.0);
    report("identification-noise.txt", &format!("identification with 2 counts of noise, {coverage}"));
    // Of ten plants one miss of a quantity is a tenth, so all quantities count together.
    assert!(coverage.fraction() >= 0.9, "{coverage}");
    // The noise is known, so a model that leaves residuals of its size follows the motions.
    assert!(coverage.follows(), "{coverage}");
}

/// Of plants whose torque and encoders have errors.
const WITH_ERRORS: Range<u64> = 8000..8006;
/// What is stated of the encoders of motor and load, the largest eccentricity of the plants.
const ENCODER_ERROR_RAD: [f64; 2] = [0.03, 0.01];

fn errors(seed: u64) -> Errors {
    let mut random = Pcg64Mcg::seed_from_u64(1_000_000 + seed);
    let mut within = |low: f64, high: f64| low + (high - low) * uniform(&mut random);
    let factor = std::env::var("WENC_FACTOR").map_or(1.0, |it| it.parse().expect("number"));
    let ecc = std::env::var("WENC_ECC").map_or(1.0, |it| it.parse().expect("number"));
    let eccentricity_rad = ENCODER_ERROR_RAD.map(|it| within(0.0, ecc * it));
    let cogging_nm = within(0.0, factor * 0.005 * LIMITS.torque_nm);
    let offset_nm = within(-0.01, 0.01) * LIMITS.torque_nm;
    let per_turn = within(1.0, 49.0) as u32;
    Errors { offset_nm, cogging_nm, per_turn, eccentricity_rad, turned_rad: within(-PI, PI) }
}

#[test]
fn truth_is_within_the_interval_with_errors_of_torque_and_encoders() {
    let mut coverage = Coverage::default();
    for seed in seeds(WITH_ERRORS) {
        let errors = errors(seed);
        let mut plant = HiddenPlant::draw(seed).with_noise(2.0).with_errors(errors, ENCODER_ERROR_RAD);
        let instruments = plant.instruments();
        let commissioned =
            commission(&mut plant, &instruments, &LIMITS, HiddenPlant::PERIOD_US, &Start::default());
        let identified = match commissioned {
            Ok(it) => it.identified,
            Err(error) => {
                println!("seed {seed}: {error} {errors:?}");
                continue;
            }
        };
        println!("{seed} {errors:?} {:?} {:?}", identified.residual_counts, identified.encoder_errors);
        coverage.plant(identified.is_followed());
        for quantity in &identified.quantities {
            let mut truth = plant.truth(quantity.name);
            if let Some(it) = quantity.estimate.filter(|_| quantity.name.ends_with("phase_rad")) {
                truth += TAU * ((it.value - truth) / TAU).round();
            }
            let shown = quantity.estimate.map(|it| Shown { low: it.low, high: it.high, truth });
            if std::env::var("WENC_V").is_ok() {
                println!("   {} {:?} truth {truth}", quantity.name, quantity.estimate);
            }
            coverage.quantity(seed, quantity.name, shown);
        }
    }
    report("identification-errors.txt", &format!("identification with errors, {coverage}"));
}
