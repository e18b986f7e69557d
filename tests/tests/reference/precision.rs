//! What single precision costs the drive, apart from what the loop makes of it.
//!
//! In a closed loop a difference of one rounding moves the instant at which a count flips, and the quantiser makes a
//! whole count of it; that is a property of the encoder and is shown in the table of the figures. Here both precisions
//! read the same counts.

use lashloop::plant::Truth;
use lashloop_firmware::control::law::{Law, LawState};
use lashloop_firmware::control::{Controller, Measurement, Real};

use crate::bench::Loop;
use crate::closed_loop::{Quantised, Reference, Sensors};
use crate::paper;

/// Reads for the loop in double precision and lets the drive's single precision listen.
struct Listener<'a> {
    double: Quantised<f64>,
    single: Quantised<f32>,
    laws: (Law<f64>, Law<f32>),
    states: (LawState<f64>, LawState<f32>),
    largest_nm: &'a mut f64,
}

impl Sensors<f64> for Listener<'_> {
    fn measure(&mut self, truth: &Truth, reference: Reference, applied_torque_nm: f64) -> Measurement<f64> {
        let double = self.double.measure(truth, reference, applied_torque_nm);
        let single = self.single.measure(truth, reference, applied_torque_nm);
        let want = self.laws.0.step(&mut self.states.0, &double).torque_nm;
        let have = self.laws.1.step(&mut self.states.1, &single).torque_nm;
        *self.largest_nm = self.largest_nm.max((have.to_f64() - want).abs());
        double
    }
}

fn largest_torque_difference_nm(bench: Loop, laws: (Law<f64>, Law<f32>), counts: u32) -> f64 {
    let mut largest_nm = 0.0;
    let listener = Listener {
        double: Quantised::new(counts, 400.0, 200.0, 1e-3),
        single: Quantised::new(counts, 400.0, 200.0, 1e-3),
        states: (laws.0.initial_state(), laws.1.initial_state()),
        laws,
        largest_nm: &mut largest_nm,
    };
    bench.run(listener);
    largest_nm
}

#[test]
fn single_precision_answers_the_same_counts_with_the_same_torque() {
    for counts in [1_000, 16_384, 1 << 20] {
        for bench in Loop::ALL {
            let laws = match bench {
                Loop::SmoothPd | Loop::HardCoulombPd => (paper::pd(), paper::pd()),
                Loop::SmoothFaithful => (paper::faithful_nominal(1e-3), paper::faithful_nominal(1e-3)),
                Loop::HardCoulombFaithful => (paper::faithful_observed(1e-3), paper::faithful_observed(1e-3)),
            };
            let have = largest_torque_difference_nm(bench, laws, counts);
            // One rounding of 20 N m is 1e-6. The estimate is a sum of 25,000 rounded increments and enters three times.
            let bound = match bench {
                Loop::SmoothPd | Loop::HardCoulombPd => 5e-6,
                Loop::SmoothFaithful | Loop::HardCoulombFaithful => 1e-4,
            };
            assert!(have <= bound, "{counts} counts, {}: have {have:e} N m, allowed {bound:e}", bench.name());
        }
    }
}
