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
    /// Inertia of the motor in kg m^2.
    pub(super) motor_inertia_kg_m2: F,
    /// Control period in s.
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

    /// The second derivative of the torque for this period, in N m/s^2. `room_nm` is what the motor has left for it, against a
    /// negative and for a positive one: a torque that the motor can't follow would run ahead of the shaft.
    pub(super) fn acceleration_nm_s2(
        &self,
        state: &WindingState<F>,
        commanded_nm: F,
        compliance_rad_nm: F,
        room_nm: (F, F),
    ) -> F {
        let pole = self.pole_rad_s;
        let wanted = pole * (pole * (commanded_nm - state.torque_nm) - (state.rate_nm_s + state.rate_nm_s));
        let limit = self.speed_limit_rad_s / compliance_rad_nm;
        let rate = (state.rate_nm_s + self.period_s * wanted).clamp(-limit, limit);
        let per_torque = F::ONE / (self.motor_inertia_kg_m2 * compliance_rad_nm);
        ((rate - state.rate_nm_s) / self.period_s).clamp(-(room_nm.0 * per_torque), room_nm.1 * per_torque)
    }

    /// Advances the torque by a period.
    pub(super) fn advance(&self, state: &mut WindingState<F>, acceleration_nm_s2: F) {
        state.rate_nm_s += self.period_s * acceleration_nm_s2;
        state.torque_nm += self.period_s * state.rate_nm_s;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WINDING: Winding<f64> =
        Winding { pole_rad_s: 39.0, speed_limit_rad_s: 600.0, motor_inertia_kg_m2: 1e-3, period_s: 1e-4 };
    const ANY_ROOM: (f64, f64) = (1e9, 1e9);

    fn step(
        state: &mut WindingState<f64>,
        commanded_nm: f64,
        compliance_rad_nm: f64,
        room: (f64, f64),
    ) -> f64 {
        let acceleration = WINDING.acceleration_nm_s2(state, commanded_nm, compliance_rad_nm, room);
        WINDING.advance(state, acceleration);
        acceleration
    }

    #[test]
    fn torque_follows_a_step_with_the_double_pole() {
        let mut state = Winding::initial_state();
        for k in 1..2000 {
            step(&mut state, 2.0, 1.0, ANY_ROOM);
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
                let acceleration = step(&mut state, 200.0, compliance_rad_nm, ANY_ROOM);
                assert!((before + 1e-4 * acceleration - state.rate_nm_s).abs() < 1e-9);
                fastest_rad_s = fastest_rad_s.max((compliance_rad_nm * state.rate_nm_s).abs());
            }
            assert!((fastest_rad_s - 600.0).abs() < 1e-9, "have {fastest_rad_s} rad/s");
            assert!((state.torque_nm - 200.0).abs() < 1e-3, "arrives at {} N m", state.torque_nm);
        }
    }

    #[test]
    fn torque_waits_for_a_motor_that_has_no_torque_left() {
        let mut state = Winding::initial_state();
        // 1e-3 kg m^2 at 2 rad/(N m): 3 N m wind with 1500 N m/s^2.
        assert!((step(&mut state, 20.0, 2.0, (0.0, 3.0)) - 1500.0).abs() < 1e-9);
        let before = state.rate_nm_s;
        assert_eq!(step(&mut state, -20.0, 2.0, (0.0, 3.0)), 0.0, "none left against it");
        assert_eq!(state.rate_nm_s, before);
    }
}
