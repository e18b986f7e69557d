//! One stage of the gears: a gap, a spring and a damper.

/// Parameters of a stage.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stage {
    pub(crate) stiffness_nm_rad: f64,
    pub(crate) damping_nm_s_rad: f64,
    /// Half the gap.
    pub(crate) dead_zone_rad: f64,
}

impl Stage {
    /// Torque of the spring alone, which is zero within the gap.
    fn elastic_nm(&self, twist_rad: f64) -> f64 {
        self.stiffness_nm_rad * (twist_rad - twist_rad.clamp(-self.dead_zone_rad, self.dead_zone_rad))
    }

    /// Transmitted torque, and the power that the damper dissipates.
    pub(crate) fn torque(&self, twist_rad: f64, rate_rad_s: f64) -> (f64, f64) {
        let elastic_nm = self.elastic_nm(twist_rad);
        let both_nm = elastic_nm + self.damping_nm_s_rad * rate_rad_s;
        let pushes = elastic_nm * both_nm > 0.0;
        let torque_nm = if pushes { both_nm } else { 0.0 };
        (torque_nm, (torque_nm - elastic_nm) * rate_rad_s)
    }

    /// Energy in the spring.
    pub(crate) fn energy_j(&self, twist_rad: f64) -> f64 {
        0.5 * self.elastic_nm(twist_rad).powi(2) / self.stiffness_nm_rad
    }
}
