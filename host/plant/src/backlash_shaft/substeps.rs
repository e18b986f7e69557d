//! The number of substeps that keeps the explicit method stable.
//!
//! Current loop and relaxing shaft come from their closed forms and need none. The shaft in contact does, and so do LuGre's
//! bristles, which slide off faster as the load moves faster.

use super::shaft::BacklashShaft;
use crate::PlantError;
use crate::limits::MAX_SUBSTEPS;

/// Largest product of fastest rate and substep. Runge-Kutta of fourth order is stable up to 2.78; the margin is for
/// a load that accelerates within the step.
const STABLE: f64 = 1.8;

impl BacklashShaft {
    /// Substeps for a step of `dt_s` that begins at a load velocity: as configured, or more if stability needs more.
    ///
    /// # Errors
    /// Stability needs more than [`MAX_SUBSTEPS`].
    pub fn substeps(&self, dt_s: f64, load_velocity_rad_s: f64) -> Result<u32, PlantError> {
        let needed = libm::ceil(self.fastest_rate_per_s(load_velocity_rad_s) * dt_s / STABLE);
        if needed > f64::from(MAX_SUBSTEPS) {
            return Err(PlantError::TooStiff { needed, dt_s });
        }
        // The step itself rejects a duration or velocity that is NaN.
        Ok((needed as u32).max(self.substeps))
    }

    /// A bound on the eigenvalues in contact, in 1/s.
    fn fastest_rate_per_s(&self, load_velocity_rad_s: f64) -> f64 {
        let m = &self.mechanics;
        let load_inertia = m.load_inertia_kg_m2 * (1.0 - self.parameters.load_mode.fraction);
        let compliance = 1.0 / m.motor_inertia_kg_m2 + m.ratio * m.ratio / load_inertia;
        let viscous_per_s =
            m.motor_friction_nm_s_rad / m.motor_inertia_kg_m2 + m.load_friction_nm_s_rad / load_inertia;
        let shaft = second_order(
            self.parameters.shaft_damping_nm_s_rad * compliance + viscous_per_s,
            m.stiffness_nm_rad * compliance + self.cogging.stiffness_nm_rad() / m.motor_inertia_kg_m2,
        );
        let load_mode = self.load_mode.map_or(0.0, |mode| {
            let [frequency_per_s, damping_per_s] = mode.rates_per_s;
            second_order(damping_per_s, frequency_per_s * frequency_per_s)
        });
        let shaft = shaft + load_mode;
        let Some(bristles) = self.load_friction.bristles else { return shaft };
        let sliding_per_s =
            bristles.stiffness_nm_rad * libm::fabs(load_velocity_rad_s) / self.load_friction.curve.least_nm();
        let bristle = second_order(
            bristles.damping_nm_s_rad / load_inertia + sliding_per_s,
            bristles.stiffness_nm_rad / load_inertia,
        );
        shaft + bristle
    }
}

/// Largest root of s^2 = damping s + stiffness: an upper bound on the magnitude of the roots of
/// s^2 + damping s + stiffness = 0.
fn second_order(damping: f64, stiffness: f64) -> f64 {
    0.5 * (damping + libm::sqrt(damping * damping + 4.0 * stiffness))
}
