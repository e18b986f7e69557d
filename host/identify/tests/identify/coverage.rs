//! The truth lies within the intervals.

use std::f64::consts::{PI, TAU};
use std::fs;
use std::ops::Range;
use std::path::Path;

use lashloop_identify::excitation::{CommissioningError, Limits, commission};
use lashloop_identify::{Direction, Source, Start};
use lashloop_plant::random::{Pcg64Mcg, SeedableRng as _, uniform};

use crate::hidden_plants::hidden::Errors;
use crate::hidden_plants::{Coverage, HiddenPlant, Shown};

/// The constants of the estimator were chosen on seeds 0 to 149, the width of the intervals with them.
const SEEDS: Range<u64> = 5000..5020;
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
fn coverage(seeds: Range<u64>, draw: impl Fn(u64) -> HiddenPlant) -> Coverage {
    let mut coverage = Coverage::default();
    for seed in seeds {
        let mut plant = draw(seed);
        let instruments = plant.instruments();
        let commissioned =
            commission(&mut plant, &instruments, &LIMITS, HiddenPlant::PERIOD_US, &Start::default());
        let identified = match commissioned {
            Ok(it) => it.identified,
            // A torque that is off may take the motor to a limit, and the motion ends there.
            Err(CommissioningError::Exceeded { .. }) if plant.errors.offset_nm != 0.0 => {
                coverage.refused();
                continue;
            }
            Err(error) => panic!("seed {seed}: {error}"),
        };
        let shown = [identified.directions.motor, identified.directions.load];
        let directions = shown.map(|it| it.map(Direction::sign));
        assert_eq!(directions, plant.signs.map(Some), "directions of seed {seed}");
        coverage.plant(identified.is_followed());
        for quantity in &identified.quantities {
            if !plant.has_truth(quantity.name) {
                continue;
            }
            let mut truth = plant.truth(quantity.name);
            if let Some(it) =
                quantity.estimate.filter(|it| quantity.name.ends_with("_phase_rad") && it.value.abs() > 1.0)
            {
                truth += TAU * ((it.value - truth) / TAU).round();
            }
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
    let coverage = coverage(seeds(SEEDS), HiddenPlant::draw);
    report("identification.txt", &format!("identification, {coverage}"));
    assert_covered(&coverage);
    assert!(coverage.follows(), "{coverage}");
}

/// Edges that jitter by up to 2 counts in either direction: a standard deviation of 1.2 counts, four times that of a count.
#[test]
fn truth_is_within_the_interval_with_noise_of_the_encoders() {
    let coverage = coverage(seeds(NOISY_SEEDS), |seed| HiddenPlant::draw(seed).with_noise(2.0));
    report("identification-noise.txt", &format!("identification with 2 counts of noise, {coverage}"));
    // Of ten plants one miss of a quantity is a tenth, so all quantities count together.
    assert!(coverage.fraction() >= 0.9, "{coverage}");
    // The noise is known, so a model that leaves residuals of its size follows the motions.
    assert!(coverage.follows(), "{coverage}");
}

/// Of plants whose torque and encoders have errors. 40 of them take some 5 min of processor time.
const SEEDS_WITH_ERRORS: Range<u64> = 8000..8006;
/// What is stated of the encoders of motor and load, and the largest eccentricity of the plants.
const ENCODER_ERROR_RAD: [f64; 2] = [0.03, 0.01];

fn errors(seed: u64) -> Errors {
    let mut random = Pcg64Mcg::seed_from_u64(1_000_000 + seed);
    let mut within = |low: f64, high: f64| low + (high - low) * uniform(&mut random);
    Errors {
        eccentricity_rad: ENCODER_ERROR_RAD.map(|it| within(0.0, it)),
        cogging_nm: within(0.0, 0.005) * LIMITS.torque_nm,
        offset_nm: within(-0.01, 0.01) * LIMITS.torque_nm,
        per_turn: within(1.0, 49.0) as u32,
        turned_rad: within(-PI, PI),
        noise_counts: within(0.0, 2.0),
    }
}

#[test]
fn truth_is_within_the_interval_with_errors_of_torque_and_encoders() {
    let coverage = coverage(seeds(SEEDS_WITH_ERRORS), |seed| {
        HiddenPlant::draw(seed).with_errors(errors(seed), ENCODER_ERROR_RAD)
    });
    report(
        "identification-errors.txt",
        &format!("identification with errors of torque and encoders, {coverage}"),
    );
    assert!(coverage.fraction() >= 0.95, "{coverage}");
    assert!(coverage.follows(), "{coverage}");
}

/// The interval is that of what is stated, so a worse encoder than stated is the only way to be wrong.
#[test]
fn an_eccentric_load_encoder_widens_the_interval_of_the_ratio_to_its_truth() {
    let ratio = |eccentricity_rad: f64, stated_rad: f64| {
        let errors = Errors { eccentricity_rad: [0.0, eccentricity_rad], ..Errors::default() };
        let mut plant = HiddenPlant::draw(3).with_errors(errors, [0.0, stated_rad]);
        let instruments = plant.instruments();
        let found = commission(&mut plant, &instruments, &LIMITS, HiddenPlant::PERIOD_US, &Start::default());
        let identified = found.expect("estimates").identified;
        assert_eq!(identified.encoder_errors[1].source, Source::Given, "{eccentricity_rad} rad");
        let it = identified.quantity("reduction_ratio").and_then(|it| it.estimate).expect("a ratio");
        let half = 0.5 * (it.high - it.low);
        ((it.value - plant.truth("reduction_ratio")).abs() / half, half / it.value)
    };
    for eccentricity_rad in [0.002, 0.01] {
        let (away, _) = ratio(eccentricity_rad, 0.0);
        assert!(away > 3.0, "stated as exact, {eccentricity_rad} rad: {away} half widths");
        let (away, width) = ratio(eccentricity_rad, eccentricity_rad);
        assert!(away < 1.0, "{eccentricity_rad} rad: {away} half widths");
        // The error of a displacement is up to the eccentricity for each rad.
        assert!(width < 2.0 * eccentricity_rad, "{eccentricity_rad} rad: {width}");
    }
}

/// No motion of the paper's bench at rest shows more than this, so a law may trust what is left.
#[test]
fn what_remains_of_the_torque_is_the_ripple_and_the_doubt_of_the_offset() {
    let errors = Errors { offset_nm: 0.15, cogging_nm: 0.06, per_turn: 8, ..Errors::default() };
    let mut plant = HiddenPlant::draw(5).with_errors(errors, [0.0; 2]);
    let instruments = plant.instruments();
    let found = commission(&mut plant, &instruments, &LIMITS, HiddenPlant::PERIOD_US, &Start::default());
    let identified = found.expect("estimates").identified;
    let likely = |name| identified.quantity(name).and_then(|it| it.estimate).expect(name);
    assert!((likely("torque_offset_nm").value - 0.15).abs() < 0.001, "{:?}", likely("torque_offset_nm"));
    assert_eq!(likely("cogging_per_turn").value, 8.0);
    let remains = likely("torque_uncertainty_nm").value;
    assert!((remains / (0.06 / 2.0_f64.sqrt()) - 1.0).abs() < 0.02, "{remains} N m");
}
