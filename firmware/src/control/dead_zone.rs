//! The disturbing torque of the dead zone.
//!
//! The transmitted torque is split into a linear part and a disturbing one, C = K z + w, equation (2). The smoothed
//! dead zone gives w = -4 K j tanh(gamma z / 2), equation (4). The steepness gamma = 1 / (2 j0) is computed once from
//! the *nominal* amplitude, equation (5), so that C has no slope at z = 0; only the amplitude j in front is estimated,
//! equation (19).

use crate::control::nominal_model::NominalModel;
use crate::law::Real;

/// The smoothed dead zone of any amplitude.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DeadZone<F> {
    four_stiffness_nm_rad: F,
    four_dead_zone_rad: F,
}

impl<F: Real> DeadZone<F> {
    /// The dead zone with the stiffness and steepness of `model`.
    pub fn new(model: &NominalModel<F>) -> Self {
        let four = F::from_f64(4.0);
        Self {
            four_stiffness_nm_rad: four * model.stiffness_nm_rad,
            four_dead_zone_rad: four * model.dead_zone_rad,
        }
    }

    /// Disturbing torque w in N m at a twist in rad, for a dead zone of the given amplitude in rad.
    pub fn disturbing_torque_nm(&self, amplitude_rad: F, twist_rad: F) -> F {
        // gamma z / 2 = z / (4 j0)
        -(self.four_stiffness_nm_rad * amplitude_rad * (twist_rad / self.four_dead_zone_rad).tanh())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dead_zone_cancels_the_spring_at_small_twist() {
        let dead_zone = DeadZone::new(&NominalModel::<f64>::default());
        let z = 1e-4;
        let transmitted = z + dead_zone.disturbing_torque_nm(0.16, z);
        // K z - 4 K j0 tanh(z / 4 j0) = K z^3 / (3 (4 j0)^2) + ...
        assert!((transmitted - z * z * z / (3.0 * 0.64 * 0.64)).abs() < 1e-18, "have {transmitted}");
    }

    #[test]
    fn dead_zone_subtracts_four_amplitudes_from_a_wound_spring() {
        let dead_zone = DeadZone::new(&NominalModel::<f64>::default());
        assert!((dead_zone.disturbing_torque_nm(0.2, -50.0) - 0.8).abs() < 1e-15);
    }
}
