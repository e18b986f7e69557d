//! Both precisions of a law on the same counts.
//!
//! In a closed loop a difference of one rounding moves the instant at which a count flips, and the quantiser makes a
//! whole count of it; that is a property of the encoder. So the loop is closed in double precision, and single precision
//! listens.

use lashloop_firmware::control::law::Law;
use lashloop_firmware::control::{Measurement, Real};
use lashloop_plant::Truth;

use crate::closed_loop::{Quantised, Reference, Sensors};

/// Reads for the loop in double precision and lets the drive's single precision listen.
pub struct Listener<'a> {
    double: Quantised<f64>,
    single: Quantised<f32>,
    laws: (Law<f64>, Law<f32>),
    largest_nm: &'a mut f64,
}

impl<'a> Listener<'a> {
    /// Keeps in `largest_nm` by how much the torques have differed, in N m.
    pub fn new(
        (double, single): (Quantised<f64>, Quantised<f32>),
        laws: (Law<f64>, Law<f32>),
        largest_nm: &'a mut f64,
    ) -> Self {
        Self { double, single, laws, largest_nm }
    }
}

impl Sensors<f64> for Listener<'_> {
    fn measure(&mut self, truth: &Truth, reference: Reference, applied_torque_nm: f64) -> Measurement<f64> {
        let double = self.double.measure(truth, reference, applied_torque_nm);
        let single = self.single.measure(truth, reference, applied_torque_nm);
        let want = self.laws.0.step(&double).torque_nm;
        let have = self.laws.1.step(&single).torque_nm;
        *self.largest_nm = self.largest_nm.max((have.to_f64() - want).abs());
        double
    }
}
