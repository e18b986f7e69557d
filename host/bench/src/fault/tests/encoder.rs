//! Faults of the encoders.

use lashloop_protocol::EncoderCounts;
use lashloop_protocol::message::EncoderSample;

use super::{scenario, seeded};
use crate::fault::encoder::EncoderFaults;
use crate::scenario::Scenario;

fn sample(motor_counts: i32) -> EncoderSample {
    let [motor_counts, load_counts] = [motor_counts.into(), 7].map(EncoderCounts::wrapping);
    EncoderSample { sequence: 9, motor_counts, load_counts, reference_rad: 0.5 }
}

/// What the drive sees of an encoder of the motor that counts these.
fn seen_in(scenario: &Scenario, counts: impl IntoIterator<Item = i32>) -> Vec<i32> {
    let mut faults = EncoderFaults::new(scenario);
    let mut step = 0;
    let see = |motor_counts| {
        let mut sample = sample(motor_counts);
        faults.apply(step, &mut sample);
        assert_eq!((sample.load_counts.get(), sample.reference_rad, sample.sequence), (7, 0.5, 9));
        step += 1;
        sample.motor_counts.get()
    };
    counts.into_iter().map(see).collect()
}

/// A fault from the third step on, for three steps.
fn seen(fault: &str, counts: impl IntoIterator<Item = i32>) -> Vec<i32> {
    seen_in(&scenario(&[&format!("{fault}\nside = \"motor\"\nat_s = 0.002\nfor_s = 0.003")]), counts)
}

const RISING: [i32; 7] = [10, 20, 30, 40, 50, 60, 70];

#[test]
fn a_stuck_encoder_holds_its_count_until_the_fault_ends() {
    assert_eq!(seen("kind = \"encoder-stuck\"", RISING), [10, 20, 30, 30, 30, 60, 70]);
}

#[test]
fn a_dead_encoder_reads_zero() {
    assert_eq!(seen("kind = \"encoder-dead\"", RISING), [10, 20, 0, 0, 0, 60, 70]);
}

#[test]
fn a_jump_offsets_every_count_and_wraps_around() {
    assert_eq!(seen("kind = \"encoder-jump\"\ncounts = -5", RISING), [10, 20, 25, 35, 45, 60, 70]);
    assert_eq!(
        seen("kind = \"encoder-jump\"\ncounts = 1", [8_388_607; 3]),
        [8_388_607, 8_388_607, -8_388_608]
    );
}

#[test]
fn an_offset_grows_evenly_and_stays() {
    let text = "kind = \"encoder-offset\"\ncounts = 100\nover_s = 0.002";
    assert_eq!(seen(text, [0; 7]), [0, 0, 0, 50, 100, 0, 0]);
}

#[test]
fn lost_counts_are_a_fraction_of_the_movement_and_stay_lost() {
    let text = "kind = \"encoder-lost-counts\"\nshare = 0.5";
    assert_eq!(seen(text, [0, 0, 100, 200, 200, 200, 300]), [0, 0, 50, 100, 100, 100, 200]);
    assert_eq!(seen(text, [0, 0, -100, -200, -200, -200, 0]), [0, 0, -50, -100, -100, -100, 100]);
}

#[test]
fn a_small_fraction_of_slow_movement_is_lost_as_well() {
    let scenario = scenario(&["kind = \"encoder-lost-counts\"\nside = \"motor\"\nat_s = 0\nshare = 0.125"]);
    assert_eq!(seen_in(&scenario, 0..=96).last(), Some(&84), "one count at a time");
}

#[test]
fn noise_stays_within_its_amplitude_reaches_it_and_has_no_bias() {
    let scenario = scenario(&["kind = \"encoder-noise\"\nside = \"motor\"\nat_s = 0\ncounts = 3"]);
    let seen = seen_in(&scenario, [0; 10_000]);
    assert_eq!((seen.iter().min(), seen.iter().max()), (Some(&-3), Some(&3)));
    // The standard deviation is 2 counts, that of the mean 0.02.
    let mean = f64::from(seen.iter().sum::<i32>()) / 1e4;
    assert!(mean.abs() < 0.1, "{mean}");
}

#[test]
fn noise_depends_on_seed_and_fault_only() {
    let noise = "kind = \"encoder-noise\"\nside = \"motor\"\nat_s = 0\ncounts = 1000";
    let draw = |seed, faults: &[&str]| seen_in(&seeded(seed, faults), [0; 50]);
    assert_eq!(draw(5, &[noise]), draw(5, &[noise]));
    assert_ne!(draw(5, &[noise]), draw(6, &[noise]));
    let one_behind = ["kind = \"torque-dead\"\nat_s = 0", noise];
    assert_ne!(draw(5, &[noise]), draw(5, &one_behind), "each fault has a stream of its own");
}

#[test]
fn a_reversed_encoder_counts_the_wrong_way_from_where_it_was() {
    assert_eq!(seen("kind = \"encoder-reversed\"", RISING), [10, 20, 30, 20, 10, 60, 70]);
}

#[test]
fn faults_of_both_encoders_keep_to_their_side() {
    let faults = EncoderFaults::new(&scenario(&["kind = \"encoder-dead\"\nside = \"load\"\nat_s = 0"]));
    let mut sample = sample(5);
    { faults }.apply(0, &mut sample);
    assert_eq!((sample.motor_counts.get(), sample.load_counts.get()), (5, 0));
}

#[test]
fn two_faults_of_one_encoder_act_one_after_the_other() {
    let scenario = scenario(&[
        "kind = \"encoder-jump\"\nside = \"motor\"\ncounts = 5\nat_s = 0.001",
        "kind = \"encoder-stuck\"\nside = \"motor\"\nat_s = 0.002",
    ]);
    assert_eq!(seen_in(&scenario, [10, 20, 30, 40]), [10, 25, 35, 35]);
}
