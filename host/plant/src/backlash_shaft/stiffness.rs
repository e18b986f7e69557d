//! How many substeps the explicit method needs to stay stable.
//!
//! The current loop and the relaxing shaft are taken from their closed forms and need none. What is left are the shaft in
//! contact and LuGre's bristles, which slide off the faster the faster the load moves.

use super::BacklashShaft;
use crate::PlantError;

/// Largest number of substeps in a step.
pub const MAX_SUBSTEPS: u32 = 4096;

/// Largest product of fastest rate and substep. Runge-Kutta of fourth order is stable up to 2.78; what is left is for a
/// load that gains speed within the step.
const STABLE: f64 = 1.8;

impl BacklashShaft {
    /// Substeps for a step of `dt_s` from a load velocity on: those that were asked for, or more if stability needs them.
    ///
    /// # Errors
    /// It would need more than [`MAX_SUBSTEPS`].
    pub fn substeps(&self, dt_s: f64, load_velocity_rad_s: f64) -> Result<u32, PlantError> {
        let needed = libm::ceil(self.fastest_rate_per_s(load_velocity_rad_s) * dt_s / STABLE);
        if needed > f64::from(MAX_SUBSTEPS) {
            return Err(PlantError::TooStiff { needed, dt_s });
        }
        // A duration or velocity that isn't a number is refused by the step itself.
        Ok((needed as u32).max(self.substeps))
    }

    /// A bound on the eigenvalues of the motion in contact, in 1/s.
    fn fastest_rate_per_s(&self, load_velocity_rad_s: f64) -> f64 {
        let m = &self.mechanics;
        let compliance = 1.0 / m.motor_inertia_kg_m2 + m.ratio * m.ratio / m.load_inertia_kg_m2;
        let viscous_per_s = m.motor_friction_nm_s_rad / m.motor_inertia_kg_m2
            + m.load_friction_nm_s_rad / m.load_inertia_kg_m2;
        let shaft = second_order(
            self.parameters.shaft_damping_nm_s_rad * compliance + viscous_per_s,
            m.stiffness_nm_rad * compliance,
        );
        let Some(bristles) = self.load_friction.bristles else { return shaft };
        let sliding_per_s =
            bristles.stiffness_nm_rad * libm::fabs(load_velocity_rad_s) / self.load_friction.curve.least_nm();
        let bristle = second_order(
            bristles.damping_nm_s_rad / m.load_inertia_kg_m2 + sliding_per_s,
            bristles.stiffness_nm_rad / m.load_inertia_kg_m2,
        );
        shaft + bristle
    }
}

/// Largest root of s^2 = damping s + stiffness: no root of s^2 + damping s + stiffness = 0 is larger in size.
fn second_order(damping: f64, stiffness: f64) -> f64 {
    0.5 * (damping + libm::sqrt(damping * damping + 4.0 * stiffness))
}
