//! Two masses on a shaft, as a drive with a hold and a sampler sees them.
//!
//! All of the load is seen from the motor: J_l = J_s / N0^2, f_l = f_s / N0^2, and theta_l = N0 theta_s.
//!
//! ```text
//! (J_m s^2 + (f_m + c) s + K) theta_e - (c s + K) theta_l = tau
//! (J_l s^2 + (f_l + c) s + K) theta_l - (c s + K) theta_e = 0
//! tau = u e^(-s delay) / (lag s + 1)
//! ```
//!
//! A torque is held for a period T and the positions are sampled, so a response has the images of all frequencies f + k / T in
//! it: with G of s, the response is the sum over k of G(s_k) (1 - e^(-s T)) / (s_k T), s_k = j 2 pi (f + k / T). G falls with
//! the square of the frequency, so few images matter.

use std::f64::consts::TAU;

use rustfft::num_complex::Complex;

/// Images on each side. G falls by 1 / s^2 and the hold by 1 / s: the first image left out is 1e-4 of the response at a third of
/// the sampling frequency, and less below.
const IMAGES: i32 = 8;

/// A drive train without a gap, seen from the motor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TwoMass {
    /// Inertia J_m of the motor in kg m^2.
    pub motor_inertia_kg_m2: f64,
    /// Inertia J_l of the load in kg m^2, seen from the motor.
    pub load_inertia_kg_m2: f64,
    /// Stiffness K in N m/rad.
    pub stiffness_nm_rad: f64,
    /// Damping c of the shaft in N m s/rad.
    pub damping_nm_s_rad: f64,
    /// Viscous friction f_m of the motor in N m s/rad.
    pub motor_friction_nm_s_rad: f64,
    /// Viscous friction f_l of the load in N m s/rad, seen from the motor.
    pub load_friction_nm_s_rad: f64,
    /// Reduction ratio N0.
    pub reduction_ratio: f64,
    /// Lag of the torque in s.
    pub lag_s: f64,
    /// Delay of the torque in s.
    pub delay_s: f64,
}

/// A pair of complex poles or zeros.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mode {
    /// Undamped frequency in Hz.
    pub frequency_hz: f64,
    /// Damping ratio.
    pub damping_ratio: f64,
}

impl TwoMass {
    /// Positions of motor and load by the torque, in rad/N m, of the continuous drive train.
    #[must_use]
    pub fn at(&self, s: Complex<f64>) -> [Complex<f64>; 2] {
        let shaft = self.damping_nm_s_rad * s + self.stiffness_nm_rad;
        let load = (self.load_inertia_kg_m2 * s + self.load_friction_nm_s_rad) * s + shaft;
        let motor = (self.motor_inertia_kg_m2 * s + self.motor_friction_nm_s_rad) * s + shaft;
        let torque = (-s * self.delay_s).exp() / (self.lag_s * s + 1.0);
        let scale = torque / (motor * load - shaft * shaft);
        [load * scale, shaft * scale / self.reduction_ratio]
    }

    /// The same of the sampled drive train with a hold of this period, at a frequency below half of the sampling frequency.
    #[must_use]
    pub fn sampled(&self, frequency_hz: f64, period_s: f64) -> [Complex<f64>; 2] {
        let held = 1.0 - Complex::new(0.0, -TAU * frequency_hz * period_s).exp();
        let mut sum = [Complex::new(0.0, 0.0); 2];
        for image in -IMAGES..=IMAGES {
            let s = Complex::new(0.0, TAU * (frequency_hz + f64::from(image) / period_s));
            let response = self.at(s);
            for (sum, response) in sum.iter_mut().zip(response) {
                *sum += response * held / (s * period_s);
            }
        }
        sum
    }

    /// Inertia of the load over that of the motor, both seen from the motor.
    #[must_use]
    pub fn inertia_ratio(&self) -> f64 {
        self.load_inertia_kg_m2 / self.motor_inertia_kg_m2
    }

    /// The zeros of the motor's response: the load swings on the shaft, and the motor stands still.
    #[must_use]
    pub fn antiresonance(&self) -> Mode {
        let frequency = (self.stiffness_nm_rad / self.load_inertia_kg_m2).sqrt();
        let damping = self.damping_nm_s_rad + self.load_friction_nm_s_rad;
        Mode {
            frequency_hz: frequency / TAU,
            damping_ratio: damping / (2.0 * self.load_inertia_kg_m2 * frequency),
        }
    }

    /// The poles: both masses swing against each other. `None` if damping leaves none that are complex.
    #[must_use]
    pub fn resonance(&self) -> Option<Mode> {
        let Self { motor_inertia_kg_m2: motor, load_inertia_kg_m2: load, stiffness_nm_rad: k, .. } = *self;
        let Self { damping_nm_s_rad: c, motor_friction_nm_s_rad: fm, load_friction_nm_s_rad: fl, .. } = *self;
        // The denominator over s, from s^3 down.
        let cubic = [
            motor * load,
            motor * (fl + c) + load * (fm + c),
            (motor + load) * k + fm * fl + c * (fm + fl),
            k * (fm + fl),
        ];
        let value = |s: Complex<f64>| cubic.iter().fold(Complex::new(0.0, 0.0), |sum, term| sum * s + term);
        let slope = |s: Complex<f64>| (3.0 * cubic[0] * s + 2.0 * cubic[1]) * s + cubic[2];
        let undamped = (k * (1.0 / motor + 1.0 / load)).sqrt();
        let mut root = Complex::new(-1e-3 * undamped, undamped);
        for _ in 0..100 {
            root -= value(root) / slope(root);
        }
        let is_complex = root.im.abs() > 1e-9 * undamped && root.norm().is_finite();
        is_complex.then(|| Mode { frequency_hz: root.norm() / TAU, damping_ratio: -root.re / root.norm() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The paper's bench with its shaft in contact.
    const PAPER: TwoMass = TwoMass {
        motor_inertia_kg_m2: 9.72e-4,
        load_inertia_kg_m2: 7.5 / 9.0,
        stiffness_nm_rad: 1.0,
        damping_nm_s_rad: 3.1e-3,
        motor_friction_nm_s_rad: 4.3e-4,
        load_friction_nm_s_rad: 16.0 / 9.0,
        reduction_ratio: 3.0,
        lag_s: 0.0,
        delay_s: 0.0,
    };

    #[test]
    fn images_give_the_exact_response_of_a_held_double_integrator() {
        // Both masses as one: T^2 / 2J (z + 1) / (z - 1)^2 exactly.
        let rigid = TwoMass {
            stiffness_nm_rad: 1e14,
            motor_inertia_kg_m2: 0.25,
            load_inertia_kg_m2: 0.75,
            damping_nm_s_rad: 0.0,
            motor_friction_nm_s_rad: 0.0,
            load_friction_nm_s_rad: 0.0,
            ..PAPER
        };
        for frequency_hz in [1.0, 10.0, 100.0, 300.0] {
            let z = Complex::new(0.0, TAU * frequency_hz * 1e-3).exp();
            let want = 1e-6 / 2.0 * (z + 1.0) / (z - 1.0).powu(2);
            let have = rigid.sampled(frequency_hz, 1e-3)[0];
            assert!((have / want - 1.0).norm() < 1e-3, "{frequency_hz} Hz: {have} and {want}");
        }
    }

    #[test]
    fn undamped_modes_are_those_of_the_formulas() {
        let undamped = TwoMass {
            damping_nm_s_rad: 0.0,
            motor_friction_nm_s_rad: 0.0,
            load_friction_nm_s_rad: 0.0,
            ..PAPER
        };
        let resonance = undamped.resonance().expect("a resonance");
        let want = (1.0 / 9.72e-4 + 9.0 / 7.5_f64).sqrt() / TAU;
        assert!((resonance.frequency_hz / want - 1.0).abs() < 1e-9 && resonance.damping_ratio.abs() < 1e-9);
        let antiresonance = undamped.antiresonance();
        assert!((antiresonance.frequency_hz / ((9.0 / 7.5_f64).sqrt() / TAU) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn the_resonance_is_a_pole_of_the_response() {
        let Mode { frequency_hz, damping_ratio } = PAPER.resonance().expect("a resonance");
        let w = TAU * frequency_hz;
        let pole = Complex::new(-damping_ratio * w, w * (1.0 - damping_ratio * damping_ratio).sqrt());
        assert!(PAPER.at(pole)[0].norm() > 1e8, "{:?}", PAPER.at(pole));
    }
}
