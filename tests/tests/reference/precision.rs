//! What single precision costs the drive, apart from what the loop makes of it.
//! That is shown in the table of the figures; here both precisions read the same counts.

use lashloop_firmware::control::law::Law;

use crate::closed_loop::Quantised;
use crate::listener::Listener;
use crate::paper;
use crate::paper_loops::Loop;

fn largest_torque_difference_nm(bench: Loop, laws: (Law<f64>, Law<f32>), counts: u32) -> f64 {
    let mut largest_nm = 0.0;
    let sensors = (Quantised::new(counts, 400.0, 200.0, 1e-3), Quantised::new(counts, 400.0, 200.0, 1e-3));
    bench.run(Listener::new(sensors, laws, &mut largest_nm));
    largest_nm
}

#[test]
fn single_precision_answers_the_same_counts_with_the_same_torque() {
    for counts in [1_000, 16_384, 1 << 20] {
        for bench in Loop::ALL {
            let laws = match bench {
                Loop::SmoothPd | Loop::HardCoulombPd => (paper::pd(), paper::pd()),
                Loop::SmoothMerzouki => (paper::merzouki_nominal(1e-3), paper::merzouki_nominal(1e-3)),
                Loop::HardCoulombMerzouki => (paper::merzouki_observed(1e-3), paper::merzouki_observed(1e-3)),
            };
            let have = largest_torque_difference_nm(bench, laws, counts);
            // One rounding of 20 N m is 1e-6. The estimate is a sum of 25,000 rounded increments and enters three times.
            let bound = match bench {
                Loop::SmoothPd | Loop::HardCoulombPd => 5e-6,
                Loop::SmoothMerzouki | Loop::HardCoulombMerzouki => 1e-4,
            };
            assert!(have <= bound, "{counts} counts, {}: have {have:e} N m, allowed {bound:e}", bench.name());
        }
    }
}
