//! A plant of one's own: motor, gear wheel and load, with a gap in each of the two stages.
//!
//! ```text
//! J_m dd(theta_m) + f_m d(theta_m) = U - C_1           motor
//! J_g dd(theta_g)                  = C_1 - C_2         wheel
//! J_l dd(theta_l) + f_l d(theta_l) = N C_2 + T         load
//! z_1 = theta_m - theta_g    z_2 = theta_g - N theta_l
//! C = K (z -+ j) + c dz/dt beyond the gap +-j, zero within; a flank never pulls
//! ```
//!
//! The library uses `lashloop-plant` only. [`model`] is all that the bench needs: it names the keys of `[plant]` and builds
//! the plant.

mod stage;
mod three_masses;

pub use three_masses::{ThreeMasses, model};
