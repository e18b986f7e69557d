//! The transmitted torque with the time that it takes to wind the shaft.
//!
//! A torque C winds the shaft by kappa C, and the motor has to turn that far: a command that jumps would need an infinite
//! motor speed. The command is therefore passed through a double pole at w, and the motor's speed and acceleration in
//! winding, kappa dC/dt and kappa d2C/dt2, are fed forward:
//!
//! ```text
//! d2C_r/dt2 = w^2 (C_s - C_r) - 2 w dC_r/dt,   |kappa dC_r/dt| <= winding speed
//! ```

use crate::law::Real;

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

#[cfg(test)]
mod tests {
    use super::*;

    const WINDING: Winding<f64> = Winding { pole_rad_s: 39.0, speed_limit_rad_s: 600.0, period_s: 1e-4 };

    #[test]
    fn torque_follows_a_step_with_the_double_pole() {
        let mut state = Winding::initial_state();
        for k in 1..2000 {
            WINDING.step(&mut state, 2.0, 1.0);
            let wt = 39.0 * 1e-4 * f64::from(k);
            let want = 2.0 * (1.0 - (1.0 + wt) * (-wt).exp());
            assert!(
                (state.torque_nm - want).abs() < 5e-3,
                "step {k}: have {}, want {want} N m",
                state.torque_nm
            );
        }
    }

    #[test]
    fn motor_speed_of_winding_is_limited_at_any_compliance() {
        for compliance_rad_nm in [0.5, 2.0] {
            let mut state = Winding::initial_state();
            let mut fastest_rad_s = 0.0_f64;
            for _ in 0..10_000 {
                let before = state.rate_nm_s;
                let acceleration = WINDING.step(&mut state, 200.0, compliance_rad_nm);
                assert!((before + 1e-4 * acceleration - state.rate_nm_s).abs() < 1e-9);
                fastest_rad_s = fastest_rad_s.max((compliance_rad_nm * state.rate_nm_s).abs());
            }
            assert!((fastest_rad_s - 600.0).abs() < 1e-9, "have {fastest_rad_s} rad/s");
            assert!((state.torque_nm - 200.0).abs() < 1e-3, "arrives at {} N m", state.torque_nm);
        }
    }
}
