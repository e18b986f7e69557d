//! The error of single precision itself: both precisions compute a torque from the same counts.
//!
//! Its effect in the closed loop stands in the table of the paper's numbers.

use crate::both_precisions::BothPrecisions;
use crate::closed_loop::Quantised;
use crate::law::Law;
use crate::paper;
use crate::paper_loops::Loop;

fn largest_torque_difference_nm(closed: Loop, laws: (Law<f64>, Law<f32>), counts: u32) -> f64 {
    let mut largest_nm = 0.0;
    let sensors = (Quantised::new(counts, 400.0, 200.0, 1e-3), Quantised::new(counts, 400.0, 200.0, 1e-3));
    closed.run(BothPrecisions::new(sensors, laws, &mut largest_nm));
    largest_nm
}

#[test]
fn single_precision_computes_the_same_torque_in_every_loop() {
    for counts in [1_000, 16_384, 1 << 20] {
        for closed in Loop::ALL {
            let laws = match closed {
                Loop::SmoothPd | Loop::HardCoulombPd => (paper::pd(), paper::pd()),
                Loop::SmoothMerzouki => (paper::merzouki_nominal(1e-3), paper::merzouki_nominal(1e-3)),
                Loop::HardCoulombMerzouki => (paper::merzouki_observed(1e-3), paper::merzouki_observed(1e-3)),
            };
            let have = largest_torque_difference_nm(closed, laws, counts);
            // One rounding of 20 N m is 1e-6. The estimate is a sum of 25,000 rounded increments and enters three times.
            let bound = match closed {
                Loop::SmoothPd | Loop::HardCoulombPd => 5e-6,
                Loop::SmoothMerzouki | Loop::HardCoulombMerzouki => 1e-4,
            };
            assert!(
                have <= bound,
                "{counts} counts, {}: have {have:e} N m, allowed {bound:e}",
                closed.name()
            );
        }
    }
}
