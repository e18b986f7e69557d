//! LuGre friction on the load (Canudas de Wit, Olsson, Astrom, Lischinsky 1995): bristles that bend and slide.

use super::parameters::BristleParameters;
use super::stribeck::Stribeck;

/// Dry friction on the load: Stribeck friction, or LuGre friction with the same curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LoadFriction {
    pub(super) curve: Stribeck,
    pub(super) bristles: Option<BristleParameters>,
}

/// LuGre friction at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bristles {
    pub(super) torque_nm: f64,
    /// Rate of the deflection in rad/s.
    pub(super) bending_rad_s: f64,
    /// Dissipated power in W: the part that the deflection does not store.
    pub(super) dissipated_w: f64,
}

impl LoadFriction {
    /// dx/dt = v - sigma_0 |v| x / g(v), F = sigma_0 x + sigma_1 dx/dt, with g the Stribeck curve.
    #[inline]
    pub(super) fn bristles(
        &self,
        of: BristleParameters,
        velocity_rad_s: f64,
        deflection_rad: f64,
    ) -> Bristles {
        let sign = if velocity_rad_s < 0.0 { -1.0 } else { 1.0 };
        let elastic_nm = of.stiffness_nm_rad * deflection_rad;
        let slides_at_nm = self.curve.magnitude_nm(velocity_rad_s, sign);
        let bending_rad_s = velocity_rad_s - libm::fabs(velocity_rad_s) * elastic_nm / slides_at_nm;
        let torque_nm = elastic_nm + of.damping_nm_s_rad * bending_rad_s;
        let dissipated_w = torque_nm * velocity_rad_s - elastic_nm * bending_rad_s;
        Bristles { torque_nm, bending_rad_s, dissipated_w }
    }
}
