//! Both precisions of a law on the same counts.
//!
//! In a closed loop a difference of one rounding moves the instant at which a count changes, and the quantiser turns it
//! into a whole count: a property of the encoder. So double precision closes the loop, and single precision computes its
//! torque from the same counts without applying it.

use lashloop_firmware::law::{Measurement, Real};
use lashloop_plant::Truth;

use crate::closed_loop::{Quantised, Reference, Sensors};
use crate::law::Law;

/// Sensors in double precision that also feed the drive's single precision.
pub(crate) struct BothPrecisions<'a> {
    double: Quantised<f64>,
    single: Quantised<f32>,
    laws: (Law<f64>, Law<f32>),
    largest_nm: &'a mut f64,
}

impl<'a> BothPrecisions<'a> {
    /// Writes the largest difference of the torques to `largest_nm`, in N m.
    pub(crate) fn new(
        (double, single): (Quantised<f64>, Quantised<f32>),
        laws: (Law<f64>, Law<f32>),
        largest_nm: &'a mut f64,
    ) -> Self {
        Self { double, single, laws, largest_nm }
    }
}

impl Sensors<f64> for BothPrecisions<'_> {
    fn measure(&mut self, truth: &Truth, reference: Reference, applied_torque_nm: f64) -> Measurement<f64> {
        let double = self.double.measure(truth, reference, applied_torque_nm);
        let single = self.single.measure(truth, reference, applied_torque_nm);
        let want = self.laws.0.step(&double).torque_nm;
        let have = self.laws.1.step(&single).torque_nm;
        *self.largest_nm = self.largest_nm.max((have.to_f64() - want).abs());
        double
    }
}
