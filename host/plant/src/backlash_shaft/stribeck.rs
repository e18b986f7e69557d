//! Stribeck friction: the curve and the changes between stick and slip.

use super::parameters::StribeckParameters;
use crate::exponential_decay::decay;
use crate::mode::DryFriction;

/// F_c + (F_s - F_c) exp(-(v / v_s)^2), with its constants computed once. The asymmetry makes friction larger forwards and
/// smaller backwards.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stribeck {
    coulomb_nm: f64,
    excess_nm: f64,
    per_velocity_s_rad: f64,
    /// (v / v_s)^2 above which the exponential is lost in the rounding of F_c.
    vanishes_at: f64,
    asymmetry: f64,
    /// Stiction against a negative and against a positive driving torque, in N m.
    pub(super) limits_nm: [f64; 2],
}

impl Stribeck {
    pub(super) fn new(parameters: StribeckParameters, asymmetry: f64) -> Self {
        let StribeckParameters { coulomb_nm, stiction_nm, velocity_rad_s } = parameters;
        let excess_nm = stiction_nm - coulomb_nm;
        // Half an ulp of F_c is at least 2^-54 F_c.
        let half_ulps = libm::log(excess_nm / coulomb_nm) + 54.0 * core::f64::consts::LN_2;
        let vanishes_at = if half_ulps.is_nan() { 0.0 } else { half_ulps.clamp(0.0, 746.0) };
        Self {
            coulomb_nm,
            excess_nm,
            per_velocity_s_rad: 1.0 / velocity_rad_s,
            vanishes_at,
            asymmetry,
            limits_nm: [stiction_nm * (1.0 - asymmetry), stiction_nm * (1.0 + asymmetry)],
        }
    }

    /// Magnitude of the friction on a mass that slips in the direction `sign`, in N m.
    #[inline(always)]
    pub(super) fn magnitude_nm(&self, velocity_rad_s: f64, sign: f64) -> f64 {
        let ratio = velocity_rad_s * self.per_velocity_s_rad;
        let squared = ratio * ratio;
        let symmetric = if squared >= self.vanishes_at {
            self.coulomb_nm
        } else {
            self.coulomb_nm + self.excess_nm * decay(squared)
        };
        symmetric * (1.0 + sign * self.asymmetry)
    }

    /// Smallest friction in motion in N m.
    pub(super) fn least_nm(&self) -> f64 {
        self.coulomb_nm * (1.0 - self.asymmetry.abs())
    }

    /// State that follows `state`, at zero velocity.
    pub(super) fn after(&self, state: DryFriction, drive_nm: f64) -> DryFriction {
        match state {
            DryFriction::Stick if drive_nm < 0.0 => DryFriction::SlipNegative,
            DryFriction::Stick => DryFriction::SlipPositive,
            _ => DryFriction::at_rest(drive_nm, self.limits_nm),
        }
    }

    /// Friction in N m, against positive motion.
    pub(super) fn torque_nm(&self, state: DryFriction, velocity_rad_s: f64, drive_nm: f64) -> f64 {
        match state {
            DryFriction::Stick => drive_nm,
            slip => slip.sign() * self.magnitude_nm(velocity_rad_s, slip.sign()),
        }
    }
}
