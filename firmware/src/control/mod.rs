//! The control laws: numbers in, a torque out.
//!
//! Everything here but [`backlash_inverse`] follows R. Merzouki, J.C. Cadiou, "Estimation of backlash phenomenon in the electromechanical
//! actuator", Control Engineering Practice 13 (2005) 973-983, doi:10.1016/j.conengprac.2004.10.016. Equation
//! numbers are that paper's. `theta_e` is the motor position, `theta_s` the load position, both in radians at their
//! own shafts; `z = theta_e - N0 theta_s` is the twist.
//!
//! | module | concept |
//! |---|---|
//! | [`nominal_model`] | the parameters J_m, f_m, J_s, f_s, N0, K, j0 the laws believe in |
//! | [`dead_zone`] | disturbing torque of the dead zone, equations (4) and (19) |
//! | [`dead_zone_observer`] | the estimate of the dead-zone amplitude, equation (19) |
//! | [`momentum_observer`] | the transmitted torque, observed on the motor side |
//! | [`feed_forward`] | what a moving reference asks for, equations (11) and (15) |
//! | [`cascade`] | the two proportional-derivative loops C1 and C2, equations (16) and (17) |
//! | [`pd`], [`merzouki`], [`merzouki_as_printed`] | the cascade before compensation, after it, and as printed |
//! | [`backlash_inverse`] | the gap inverted in the torque domain, identified by least squares; not of the paper |
//! | [`law`] | the choice between them at run time |
//! | [`sensing`] | encoder counts to [`Measurement`] |
//!
//! The laws are generic over [`Real`], so that the code which runs in the drive in `f32` is the code that is compared
//! with independent solvers in `f64`. Parameters are separate from state: `step(&self, &mut State, ..)`.

pub mod backlash_inverse;
pub mod cascade;
mod controller;
pub mod dead_zone;
pub mod dead_zone_observer;
mod encoder_channel;
pub mod feed_forward;
pub mod law;
mod measurement;
pub mod merzouki;
pub mod merzouki_as_printed;
pub mod momentum_observer;
pub mod nominal_model;
pub(crate) mod parameter_error;
pub mod pd;
mod real;
mod reference_rates;
pub mod sensing;
mod stateful;

pub use controller::Controller;
pub use measurement::{ControlOutput, Measurement};
pub use parameter_error::ParameterError;
pub use real::Real;
pub use stateful::Stateful;
