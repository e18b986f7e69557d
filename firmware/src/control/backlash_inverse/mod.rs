//! The cascade that inverts the gap where it sits.
//!
//! The paper's law compensates the gap by a disturbing torque w_hat, which an observer adapts to the load error. With
//! friction on the load w_hat absorbs that friction; the load overshoots and creeps. Here the load loop requests a
//! *transmitted torque* C_d, and the gap is inverted in the torque domain:
//!
//! ```text
//! z_d = kappa C_d + j_hat sat(C_d / c0)
//! U   = C_d + f_m d(theta_e) + K_m (z_d - z) - B_m (d(theta_e) - N0 d(theta_s))
//! ```
//!
//! Both encoders measure the twist z, so the motor loop closes around the gap. The law assumes no shape of the gap's
//! edges: on the paper's smooth plant the identified line |z| = kappa |C| + j_hat is the chord of the smooth curve at
//! the torques in use, and j_hat becomes its asymptotic half gap of 4 j0.
//!
//! | module | concept |
//! |---|---|
//! | `gains` | gains and limits to tune |
//! | `inverse` | the law |
//! | `load_loop` | proportional and proportional-integral loop of the load, with a hold on arrival |

mod gains;
mod inverse;
mod load_loop;
#[cfg(test)]
mod tests;

pub use gains::BacklashInverseGains;
pub use inverse::{BacklashInverse, BacklashInverseSetting};
