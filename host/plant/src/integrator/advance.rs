//! Substeps over the time for which a torque is held.

use super::event::locate;
use super::hybrid::HybridSystem;
use crate::PlantError;
use crate::limits::MAX_EVENTS;

/// Holds the torque for `dt_s` seconds in `substeps` equal substeps. Of several events in a substep the earliest counts.
///
/// # Errors
/// See [`PlantError`].
pub fn advance<S: HybridSystem>(
    system: &S,
    x: &mut S::State,
    mode: &mut S::Mode,
    torque_nm: f64,
    dt_s: f64,
    substeps: u32,
) -> Result<(), PlantError> {
    if !torque_nm.is_finite() {
        return Err(PlantError::Torque { torque_nm });
    }
    if !(dt_s >= 0.0 && dt_s.is_finite()) {
        return Err(PlantError::Duration { dt_s });
    }
    let substep_s = dt_s / f64::from(substeps);
    *mode = system.settle(x, *mode, torque_nm);
    let stride = system.stride(substep_s);
    for _ in 0..substeps {
        let end = system.flow(x, *mode, torque_nm, stride);
        if S::GUARDS.iter().all(|&guard| system.guard(guard, &end, *mode) >= 0.0) {
            *x = end;
        } else {
            substep_with_events(system, x, mode, torque_nm, substep_s)?;
        }
    }
    if system.is_in_range(x) { Ok(()) } else { Err(PlantError::NotFinite { torque_nm }) }
}

/// A substep in which a mode ends. We keep it out of line so that the common substep stays short.
#[cold]
#[inline(never)]
fn substep_with_events<S: HybridSystem>(
    system: &S,
    x: &mut S::State,
    mode: &mut S::Mode,
    torque_nm: f64,
    substep_s: f64,
) -> Result<(), PlantError> {
    let mut rest_s = substep_s;
    for _ in 0..=MAX_EVENTS {
        let end = system.flow(x, *mode, torque_nm, system.stride(rest_s));
        let violated = S::GUARDS.iter().copied().filter(|&guard| system.guard(guard, &end, *mode) < 0.0);
        let located = violated.map(|guard| (locate(system, guard, x, *mode, torque_nm, rest_s), guard));
        let Some((event_s, guard)) = located.min_by(|a, b| a.0.total_cmp(&b.0)) else {
            *x = end;
            return Ok(());
        };
        *x = system.flow(x, *mode, torque_nm, system.stride(event_s));
        *mode = system.switch(guard, x, *mode);
        rest_s -= event_s;
        if rest_s <= 0.0 {
            return Ok(());
        }
    }
    Err(PlantError::Chattering { substep_s })
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector2;

    use super::*;
    use crate::integrator::runge_kutta::runge_kutta;
    use crate::limits::are_in_range;

    /// A ball under constant acceleration over a floor at zero, where it stays after landing.
    struct Landing;

    impl HybridSystem for Landing {
        type State = Vector2<f64>;
        type Mode = bool;
        type Stride = f64;
        type Guard = ();
        const GUARDS: &'static [()] = &[()];

        fn stride(&self, h_s: f64) -> f64 {
            h_s
        }

        fn flow(&self, x: &Vector2<f64>, landed: bool, torque_nm: f64, h_s: f64) -> Vector2<f64> {
            let falling = |x: &Vector2<f64>, _| Vector2::new(x[1], torque_nm);
            if landed { *x } else { runge_kutta(x, h_s, &falling) }
        }

        fn guard(&self, (): (), x: &Vector2<f64>, landed: bool) -> f64 {
            if landed { 1.0 } else { x[0] }
        }

        fn switch(&self, (): (), x: &mut Vector2<f64>, _landed: bool) -> bool {
            x[0] = 0.0;
            true
        }

        fn settle(&self, _x: &mut Vector2<f64>, landed: bool, _torque_nm: f64) -> bool {
            landed
        }

        fn is_in_range(&self, x: &Vector2<f64>) -> bool {
            are_in_range(x)
        }
    }

    /// A system whose guard function is violated in both of its modes.
    struct Chatterer;

    impl HybridSystem for Chatterer {
        type State = Vector2<f64>;
        type Mode = bool;
        type Stride = f64;
        type Guard = ();
        const GUARDS: &'static [()] = &[()];

        fn stride(&self, h_s: f64) -> f64 {
            h_s
        }

        fn flow(&self, x: &Vector2<f64>, _mode: bool, _torque_nm: f64, _h_s: f64) -> Vector2<f64> {
            *x
        }

        fn guard(&self, (): (), _x: &Vector2<f64>, _mode: bool) -> f64 {
            -1.0
        }

        fn switch(&self, (): (), _x: &mut Vector2<f64>, mode: bool) -> bool {
            !mode
        }

        fn settle(&self, _x: &mut Vector2<f64>, mode: bool, _torque_nm: f64) -> bool {
            mode
        }

        fn is_in_range(&self, _x: &Vector2<f64>) -> bool {
            true
        }
    }

    #[test]
    fn event_is_located_where_the_closed_form_has_it() {
        // From 1 m at -9.81 m/s^2: down after sqrt(2 / 9.81) s at sqrt(2 * 9.81) m/s, within a single step of 1 s.
        let (mut x, mut landed) = (Vector2::new(1.0, 0.0), false);
        advance(&Landing, &mut x, &mut landed, -9.81, 1.0, 1).expect("lands");
        assert!(landed);
        assert_eq!(x[0], 0.0);
        let want = -(2.0_f64 * 9.81).sqrt();
        assert!((x[1] - want).abs() < 1e-11, "have {} m/s, want {want} m/s", x[1]);
    }

    #[test]
    fn endless_switching_is_reported_as_chattering() {
        let error =
            advance(&Chatterer, &mut Vector2::zeros(), &mut false, 0.0, 1e-3, 4).expect_err("never ends");
        assert_eq!(error, PlantError::Chattering { substep_s: 2.5e-4 });
        assert!(error.to_string().starts_with("plant is chattering: more than 64 changes"), "{error}");
    }

    #[test]
    fn bad_input_is_rejected_before_the_state_moves() {
        let (mut x, mut landed) = (Vector2::new(1.0, 0.0), false);
        let rejected = advance(&Landing, &mut x, &mut landed, f64::NAN, 1.0, 1);
        assert!(matches!(rejected, Err(PlantError::Torque { .. })));
        assert!(matches!(
            advance(&Landing, &mut x, &mut landed, 0.0, -1.0, 1),
            Err(PlantError::Duration { dt_s: -1.0 })
        ));
        assert_eq!(x, Vector2::new(1.0, 0.0));
    }

    #[test]
    fn overflow_of_the_state_is_an_error() {
        let (mut x, mut landed) = (Vector2::new(1.0, f64::MAX), false);
        let rejected = advance(&Landing, &mut x, &mut landed, f64::MAX, 1e9, 1);
        assert!(matches!(rejected, Err(PlantError::NotFinite { .. })), "{rejected:?}");
    }
}
