//! Published control laws for drives with backlash, on the bench with Lashloop's own.
//!
//! | module | law |
//! |---|---|
//! | [`dead_band_cascade`] | proportional control with a dead band around a velocity loop |
//! | [`switched_gains`] | one state feedback in contact, another one in the gap |
//! | [`sliding_mode`] | a sliding surface behind an inverse of the nominal gap |
//! | [`adaptive_inverse`] | a velocity cascade behind an inverse that adapts by the gradient |
//! | [`kalman_inverse`] | an inverse of the gap that a two-mode Kalman filter estimates |
//! | [`predictive`] | model predictive control with a model of contact and gap |
//! | [`common`] | what several laws have in common |
//! | `study` | tuning and comparison, on a PC |
//!
//! Each law states its source and every deviation from it. All have the measurements, the period, the torque limit and the
//! nominal mechanics that Lashloop's laws have.

#![no_std]
#![forbid(unsafe_code)]

#[cfg(not(target_os = "none"))]
extern crate std;

pub mod adaptive_inverse;
pub mod common;
pub mod dead_band_cascade;
pub mod kalman_inverse;
pub mod predictive;
pub mod sliding_mode;
#[cfg(not(target_os = "none"))]
pub mod study;
pub mod switched_gains;

use lashloop_firmware::control::backlash_inverse::BacklashInverse;
use lashloop_firmware::control::braking_curve::BrakingCurve;
use lashloop_firmware::control::merzouki::Merzouki;
use lashloop_firmware::control::pd::Pd;

lashloop_firmware::laws! {
    /// The laws of this drive. The first one is in force after power-up.
    pub enum PublishedLaws {
        /// Lashloop's laws.
        Pd(Pd),
        /// As above.
        Merzouki(Merzouki),
        /// As above.
        BacklashInverse(BacklashInverse),
        /// As above.
        BrakingCurve(BrakingCurve),
        /// A law of this crate.
        DeadBandCascade(dead_band_cascade::DeadBandCascade),
        /// As above.
        SwitchedGains(switched_gains::SwitchedLaw),
        /// As above.
        SlidingMode(sliding_mode::SlidingMode),
        /// As above.
        AdaptiveInverse(adaptive_inverse::AdaptiveInverse),
        /// As above.
        KalmanInverse(kalman_inverse::KalmanInverse),
        /// As above.
        Predictive(predictive::Predictive),
    }
}
