//! The control laws: numbers in, a torque out.
//!
//! Everything here but [`backlash_inverse`], [`braking_curve`] and [`open_loop`] follows R. Merzouki, J.C. Cadiou,
//! "Estimation of backlash phenomenon in the electromechanical actuator", Control Engineering Practice 13 (2005) 973-983,
//! doi:10.1016/j.conengprac.2004.10.016.
//! Equation numbers are those of the paper. `theta_e` is the motor position, `theta_s` the load position, both in
//! radians at their own shafts; `z = theta_e - N0 theta_s` is the twist.
//!
//! | module | concept |
//! |---|---|
//! | [`nominal_model`] | nominal parameters J_m, f_m, J_s, f_s, N0, K, j0 |
//! | [`dead_zone`] | disturbing torque of the dead zone, equations (4) and (19) |
//! | [`dead_zone_observer`] | estimate of the dead-zone amplitude, equation (19) |
//! | [`momentum_observer`] | transmitted torque, observed on the motor side |
//! | [`feed_forward`] | torques of a moving reference, equations (11) and (15) |
//! | [`cascade`] | the two proportional-derivative loops C1 and C2, equations (16) and (17) |
//! | [`cascade_signals`] | the signals of these laws |
//! | [`pd`], [`merzouki`] | the cascade before compensation, and after it |
//! | [`merzouki_as_printed`] | the compensation without lead and free control |
//! | [`backlash_inverse`] | the gap inverted in the torque domain and identified by least squares; not from the paper |
//! | [`braking_curve`] | that inverse, led along a braking curve with margin for plants within a tolerance; not from the paper |
//! | [`open_loop`] | the reference as a torque, for commissioning |
//! | `lag` | gain of a first-order lag |
//! | `load_observer` | load velocity from counts |
//! | `motor_friction` | direction of the motor's dry friction |
//! | `gap_identification` | compliance, half gap and the torque's offset by recursive least squares |
//! | [`torque_knowledge`] | what is known of the torque's offset and cogging |
//! | [`sensing`] | encoder counts to [`Measurement`](crate::law::Measurement) |
//! | `encoder_channel` | one encoder: wraparound, position, velocity filter |
//! | `reference_rates` | velocity and acceleration of the reference |
//!
//! The laws are generic over [`Real`](crate::law::Real): the drive runs in `f32` the same code that tests compare with
//! independent solvers in `f64`. A law is one value: its constants and its state.

pub mod backlash_inverse;
pub mod braking_curve;
pub mod cascade;
pub mod cascade_signals;
pub mod dead_zone;
pub mod dead_zone_observer;
mod encoder_channel;
pub mod feed_forward;
mod gap_identification;
mod lag;
mod load_observer;
pub mod merzouki;
pub mod merzouki_as_printed;
pub mod momentum_observer;
mod motor_friction;
pub mod nominal_model;
pub mod open_loop;
pub mod pd;
mod reference_rates;
pub mod sensing;
#[cfg(test)]
mod tests;
pub mod torque_knowledge;
