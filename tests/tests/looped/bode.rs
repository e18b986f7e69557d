//! Frequency responses of the loop against closed forms, and of drive trains that nobody told the measurement of.

use std::f64::consts::TAU;
use std::ops::Range;

use lashloop::Bench;
use lashloop::bode::{Measurement, measure};
use lashloop_bench::run::Clock;
use lashloop_bench::supervisor::Supervisor;
use lashloop_response::response::{Excited, Line, decibels};
use lashloop_response::two_mass::TwoMass;
use lashloop_response::{Complex, Excitation, Measured, Plan, gap, table};
use tests::program;
use tests::records::Records;

use crate::hidden_plant_keys::KEYS;
use crate::hidden_plants::HiddenPlant;

/// The paper's bench without dry friction, held against one side of a gap of nothing by a torque on the load: a contact that opens
/// is not linear.
const LINEAR: &str = r#"
title = "two masses"
meant = ["mismatch"]
[run]
duration_s = 1.0
[plant]
model = "backlash-shaft"
dead_zone_rad = 1e-6
load_coulomb_nm = 0.0
load_stiction_nm = 0.0
motor_coulomb_nm = 0.0
motor_stiction_nm = 0.0
load_torque.torque_nm = 6.0
initial = { load_position_rad = 0.0, motor_position_rad = 0.0 }
[controller]
name = "pd"
[reference]
profile = "constant"
position_rad = 0.0
"#;

const PLAN: Plan = Plan {
    control_period_us: 1000,
    excitation: Excitation::Multisine,
    amplitude: 0.5,
    lowest_hz: 0.1,
    highest_hz: 200.0,
    lines: 60,
    realisations: 8,
    windows: 1,
    settles_s: 20.0,
    seed: 1,
};

/// What the scenario of [`LINEAR`] says of its plant.
const TRUTH: TwoMass = TwoMass {
    motor_inertia_kg_m2: 9.72e-4,
    load_inertia_kg_m2: 7.5 / 9.0,
    stiffness_nm_rad: 1.0,
    damping_nm_s_rad: 3.1e-3,
    motor_friction_nm_s_rad: 4.3e-4,
    load_friction_nm_s_rad: 16.0 / 9.0,
    reduction_ratio: 3.0,
    lag_s: 5e-4,
    delay_s: 1e-3,
};

fn measured(text: &str, settings: &[&str], plan: &Plan) -> Measurement {
    let bench = Bench::new();
    let scenario = bench.scenario_from_str(text, settings).expect("a scenario");
    let device = bench.device("inproc").expect("a device");
    let supervisor = Supervisor::without_signals(None).expect("a supervisor");
    let measurement = measure(&scenario, (&device).into(), Clock::Lockstep, &supervisor, plan, 0.0);
    measurement.unwrap_or_else(|error| panic!("{settings:?}: {error}")).expect("no signal")
}

/// What a line misses of the truth, in dB and in degrees.
fn error(line: &Line, truth: Complex<f64>) -> (f64, f64) {
    let ratio = line.value / truth;
    (decibels(ratio.norm()), ratio.arg().to_degrees())
}

#[test]
fn plant_without_a_gap_is_that_of_two_masses_within_a_tenth_of_a_decibel_and_a_degree() {
    let Measurement { measured, fit, .. } = measured(LINEAR, &[], &PLAN);
    for line in &measured.motor {
        let (db, deg) = error(line, TRUTH.sampled(line.frequency_hz, 1e-3)[0]);
        assert!(line.coherence > 0.95, "{line:?}");
        assert!(db.abs() < 0.1 && deg.abs() < 1.0, "{} Hz: {db} dB, {deg} deg", line.frequency_hz);
    }
    // The load moves by a few counts only, and its lines say so.
    let load = measured.load.iter().filter(|it| it.coherence > 0.95);
    let (mut within, mut of) = (0, 0);
    for line in load {
        let (db, deg) = error(line, TRUTH.sampled(line.frequency_hz, 1e-3)[1]);
        let is_within = db.abs() < line.within_db().max(0.1) && deg.abs() < line.within_deg().max(1.0);
        (within, of) = (within + usize::from(is_within), of + 1);
    }
    assert!(of > 15 && 10 * within >= 9 * of, "{within} of {of}");
    let fit = fit.expect("a fit");
    let resonance = TRUTH.resonance().expect("a resonance").frequency_hz;
    assert!(fit.resonance_hz.is_some_and(|it| it.contains(resonance)), "{fit:?}, want {resonance} Hz");
    assert!(fit.antiresonance_hz.contains(TRUTH.antiresonance().frequency_hz), "{fit:?}");
}

#[test]
fn crossover_moves_with_the_gain_and_the_largest_sensitivity_is_one_over_the_least_distance_to_minus_one() {
    let of = |gain: &str| {
        let set = format!("controller.parameters.k_p1={gain}");
        let plan = Plan { lowest_hz: 1.0, settles_s: 10.0, ..PLAN };
        measured(LINEAR, &[&set], &plan)
    };
    let (soft, stiff) = (of("0.5"), of("1"));
    let [low, high] = [&soft, &stiff].map(|it| it.margins.phase.expect("a crossover"));
    assert!(low.frequency_hz < high.frequency_hz, "{low:?}, {high:?}");
    let least = |it: &Measurement| {
        it.measured.open_loop.iter().map(|it| (it.value + 1.0).norm()).fold(f64::MAX, f64::min)
    };
    for it in [&soft, &stiff] {
        let sensitivity = it.margins.sensitivity.expect("a largest value");
        assert!((sensitivity.value * least(it) - 1.0).abs() < 1e-9, "{sensitivity:?}");
    }
}

/// First harmonic of the shaft's torque over that of the twist. The torque is what moves the load.
#[test]
fn first_harmonic_with_a_gap_is_that_of_the_describing_function() {
    const HALF_GAP_RAD: f64 = 0.05;
    let settings = [
        "plant.dead_zone_rad=0.05",
        "plant.shaft_damping_nm_s_rad=0",
        "plant.load_torque.torque_nm=0",
        "encoders.motor_counts_per_rev=16777216",
        "encoders.load_counts_per_rev=16777216",
    ];
    let mut shares = Vec::new();
    for amplitude in [0.3, 0.6, 2.0] {
        // Above the resonance the inertia of the motor makes a sine of the twist.
        let plan = Plan {
            excitation: Excitation::Sine,
            amplitude,
            lowest_hz: 9.0,
            highest_hz: 14.0,
            lines: 3,
            realisations: 3,
            windows: 4,
            settles_s: 10.0,
            ..PLAN
        };
        let spectra = measured_lines(&settings, &plan);
        for (at, (motor, load)) in spectra.motor.iter().zip(&spectra.load).enumerate() {
            let s = Complex::new(0.0, TAU * motor.frequency_hz);
            let load_rad = load.value * TRUTH.reduction_ratio;
            let twist_rad = motor.value - load_rad;
            let torque = (TRUTH.load_inertia_kg_m2 * s + TRUTH.load_friction_nm_s_rad) * s * load_rad;
            let have = (torque / twist_rad).norm();
            let amplitude_rad = twist_rad.norm() * spectra.torque_nm[at];
            let want = TRUTH.stiffness_nm_rad * gap::share_for_sine(amplitude_rad / HALF_GAP_RAD);
            let frequency_hz = motor.frequency_hz;
            assert!(
                (have - want).abs() < 0.03,
                "{frequency_hz} Hz, twist {amplitude_rad} rad: have {have}, want {want}"
            );
            shares.push(want);
        }
    }
    let [least, most] = [f64::min, f64::max].map(|of| shares.iter().copied().reduce(of).expect("shares"));
    assert!(least < 0.4 && most > 0.8, "{shares:?}");
}

fn measured_lines(settings: &[&str], plan: &Plan) -> Measured {
    measured(LINEAR, settings, plan).measured
}

#[test]
fn apparent_stiffness_of_a_series_is_what_the_describing_function_leaves_to_noise() {
    let settings = ["plant.dead_zone_rad=0.1", "plant.load_torque.torque_nm=0"];
    let mut resonances = Vec::new();
    for amplitude in [1.0, 2.0, 4.0] {
        let measurement = measured(LINEAR, &settings, &Plan { amplitude, ..PLAN });
        let fit = measurement.fit.expect("a fit");
        let twist_rms_rad = measurement.twist_rms_rad.expect("a twist");
        let want = gap::share_for_noise(twist_rms_rad / 0.1);
        let have = fit.stiffness_nm_rad.value;
        assert!((have - want).abs() < 0.03, "{amplitude} N m: have {have}, want {want}");
        resonances.push(fit.resonance_hz.expect("a resonance").value);
    }
    assert!(resonances.is_sorted(), "{resonances:?}");
}

/// Gap and dry friction as well: a constant torque keeps the load in motion and the gap closed.
#[test]
fn stiffness_and_inertia_ratio_of_hidden_plants_lie_within_the_stated_intervals() {
    let seeds = hidden_plants();
    let mut found = [0; 2];
    let mut text = String::new();
    for seed in seeds.clone() {
        let plant = HiddenPlant::draw(seed);
        let mut settings = KEYS.map(|key| format!("plant.{key}={:?}", plant.truth(key))).to_vec();
        for (side, counts) in ["motor", "load"].into_iter().zip(plant.counts_per_rev) {
            settings.push(format!("encoders.{side}_counts_per_rev={counts}"));
        }
        let moving =
            ["controller.name=open-loop", "reference.position_rad=8", "plant.load_torque.torque_nm=0"];
        settings.extend(moving.map(str::to_owned));
        let settings: Vec<&str> = settings.iter().map(String::as_str).collect();
        let plan = Plan { amplitude: 4.0, ..PLAN };
        let measurement = measured(LINEAR, &settings, &plan);
        let fit = measurement.fit.unwrap_or_else(|error| panic!("plant {seed}: {error}"));
        let truth = |name: &str| plant.truth(name);
        let load_inertia = truth("load_inertia_kg_m2") / truth("reduction_ratio").powi(2);
        let pairs = [
            (fit.stiffness_nm_rad, truth("stiffness_nm_rad")),
            (fit.inertia_ratio, load_inertia / truth("motor_inertia_kg_m2")),
        ];
        for (count, (estimate, truth)) in found.iter_mut().zip(pairs) {
            *count += usize::from(estimate.contains(truth));
            let half_width = (estimate.high / estimate.low - 1.0) / 2.0;
            text += &format!("{seed}: {truth:.4}, {estimate:?}\n");
            assert!(half_width < 0.05, "plant {seed}: an interval of {estimate:?} says nothing");
        }
    }
    let all = seeds.count();
    println!("{} of stiffness, {} of the inertia ratio, of {all}", found[0], found[1]);
    assert!(found.iter().all(|count| 10 * count >= 9 * all), "{found:?} of {all}\n{text}");
}

/// The seeds of the hidden plants; other ones by `LASHLOOP_HIDDEN_PLANTS=FIRST..END`.
fn hidden_plants() -> Range<u64> {
    let given = std::env::var("LASHLOOP_HIDDEN_PLANTS").ok();
    let given = given.as_deref().and_then(|it| it.split_once(".."));
    given.map_or(9100..9120, |(first, end)| first.parse().expect("a seed")..end.parse().expect("a seed"))
}

/// The drive reads its own encoders, and its law makes a torque of the reference.
#[test]
fn plant_behind_the_pins_of_a_drive_is_measured_by_the_reference() {
    let settings = [
        "run.mode=bench",
        "bench.torque_per_duty_nm=62.5",
        "bench.twist_limit_rad=40",
        "controller.name=open-loop",
        "reference.position_rad=6",
    ];
    let text = LINEAR.replace("load_torque.torque_nm = 6.0\n", "");
    let plan = Plan { amplitude: 3.0, lowest_hz: 0.2, settles_s: 10.0, realisations: 4, ..PLAN };
    let Measurement { excited, measured, fit, .. } = measured(&text, &settings, &plan);
    assert_eq!(excited, Excited::Reference);
    assert!(measured.sensitivity.is_empty() && !measured.closed_loop.is_empty());
    let fit = fit.expect("a fit");
    assert!(fit.stiffness_nm_rad.contains(TRUTH.stiffness_nm_rad), "{fit:?}");
    assert!(fit.inertia_ratio.contains(TRUTH.inertia_ratio()), "{fit:?}");
}

#[test]
fn a_seed_repeats_every_byte_of_the_table_and_another_seed_does_not() {
    let of = |seed: u64| {
        let plan = Plan { lowest_hz: 1.0, settles_s: 1.0, realisations: 3, seed, ..PLAN };
        let Measurement { excited, measured, .. } = measured(LINEAR, &[], &plan);
        table::csv(excited, [(plan.amplitude, &measured)])
    };
    let first = of(1);
    assert!(first.lines().count() > 100, "{first}");
    assert_eq!(first, of(1));
    assert_ne!(first, of(2));
}

#[test]
fn what_prevents_a_response_is_named_with_a_remedy() {
    let records = Records::new();
    let scenario = records.path("linear.toml");
    std::fs::write(&scenario, LINEAR).expect("a file");
    let scenario = scenario.to_str().expect("UTF-8");
    let quick = ["--lowest-hz", "5", "--settles-s", "1", "--realisations", "3", "--lines", "12"];
    for (arguments, code, want) in [
        (&["--highest-hz", "600"][..], 2, "at a period of 1000 us take at most 500 Hz"),
        (&["--amplitudes", "30"], 3, "take smaller --amplitudes"),
        (&["--amplitudes", "1e-6"], 3, "raise the amplitude"),
        (
            &["--set", "controller.parameters.motor_speed_limit_rad_s=0.5", "--amplitudes", "2"],
            3,
            "take smaller --amplitudes",
        ),
    ] {
        let arguments = ["bode", scenario].into_iter().chain(quick).chain(arguments.iter().copied());
        let ended = program::run(arguments.clone()).with_code(code);
        assert!(ended.stderr.contains(want), "{:?}: {}", arguments.collect::<Vec<_>>(), ended.stderr);
    }
}
