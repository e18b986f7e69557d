//! The transmitted torque with the time that it takes to wind the shaft.
//!
//! A torque C winds the shaft by kappa C, and the motor has to turn that far: a command that jumps would need an infinite
//! motor speed. The command is therefore passed through a double pole at w, and the motor's speed and acceleration in
//! winding, kappa dC/dt and kappa d2C/dt2, are fed forward:
//!
//! ```text
//! d2C_r/dt2 = w^2 (C_s - C_r) - 2 w dC_r/dt,   |kappa dC_r/dt| <= winding speed
//! ```

use crate::control::Real;

/// The filter with its constants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Winding<F> {
    pub(super) pole_rad_s: F,
    pub(super) speed_limit_rad_s: F,
    pub(super) period_s: F,
}

/// State of the filter: the torque in N m and its rate in N m/s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct WindingState<F> {
    pub(super) torque_nm: F,
    pub(super) rate_nm_s: F,
}

impl<F: Real> Winding<F> {
    pub(super) fn initial_state() -> WindingState<F> {
        WindingState { torque_nm: F::ZERO, rate_nm_s: F::ZERO }
    }

    /// Advances the torque by a period and returns its second derivative in N m/s^2.
    pub(super) fn step(&self, state: &mut WindingState<F>, commanded_nm: F, compliance_rad_nm: F) -> F {
        let pole = self.pole_rad_s;
        let wanted = pole * (pole * (commanded_nm - state.torque_nm) - (state.rate_nm_s + state.rate_nm_s));
        let limit = self.speed_limit_rad_s / compliance_rad_nm;
        let rate = (state.rate_nm_s + self.period_s * wanted).clamp(-limit, limit);
        let acceleration = (rate - state.rate_nm_s) / self.period_s;
        state.rate_nm_s = rate;
        state.torque_nm += self.period_s * rate;
        acceleration
    }
}
