//! The shortest settling time that the motor of a plant can reach, by its torque and friction.
//!
//! The whole of the plant is one inertia, J = J_s + N0^2 J_m, with all viscous and all Coulomb friction at the load. It
//! accelerates with the full torque and brakes with the full torque. The shaft is left out, because it gives back the
//! impulse that it takes: what winds it at the start of a move arrives at the load before the end. So do the motor's
//! crossings of the gap. Both minima of benchmarks/minimum-time, which computes the shaft and the gap by collocation, are
//! within 2 % of this one; a test compares them.

use super::shaft::BacklashShaft;
use crate::metrics::SETTLED_RAD;

/// Overshoot that a settled load may have in rad, as in benchmarks/minimum-time.
const OVERSHOOT_RAD: f64 = 0.005;

/// Constant torque and viscous friction on an inertia: dv/dt = (torque +- friction v) / inertia.
#[derive(Debug, Clone, Copy)]
struct Stretch {
    inertia_kg_m2: f64,
    /// Negative while the motor accelerates, positive while it brakes.
    friction_nm_s_rad: f64,
    torque_nm: f64,
}

impl Stretch {
    /// Time in s and distance in rad between rest and a speed.
    fn until(&self, speed_rad_s: f64) -> (f64, f64) {
        let Self { inertia_kg_m2, friction_nm_s_rad, torque_nm } = *self;
        let (x, slow_s) =
            (friction_nm_s_rad * speed_rad_s / torque_nm, inertia_kg_m2 * speed_rad_s / torque_nm);
        // ln(1 + x) / x and its integral; the series where the difference of the closed form is lost in rounding.
        if libm::fabs(x) < 1e-4 {
            return (slow_s * (1.0 - x / 2.0), slow_s * speed_rad_s * (0.5 - x / 3.0));
        }
        let logarithm = libm::log1p(x);
        (slow_s * logarithm / x, slow_s * speed_rad_s * (x - logarithm) / (x * x))
    }

    /// Speed in rad/s from 0 to `highest_rad_s` at which the stretch has a length.
    fn speed_rad_s(&self, distance_rad: f64, highest_rad_s: f64) -> f64 {
        bisected(highest_rad_s, |speed_rad_s| self.until(speed_rad_s).1 < distance_rad)
    }
}

/// The argument from 0 to `highest` up to which a condition holds.
fn bisected(highest: f64, holds: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high) = (0.0, highest);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        *(if holds(middle) { &mut low } else { &mut high }) = middle;
    }
    low
}

impl BacklashShaft {
    /// The shortest `settle_time_s` in s of a move by `distance_rad` from rest, positive towards positive angles, of a drive
    /// whose torque arrives `delay_s` after a sample; it includes the lag of the current loop. `None` if the motor can't move
    /// the load.
    #[must_use]
    pub fn minimum_settle_time_s(&self, distance_rad: f64, delay_s: f64) -> Option<f64> {
        let (m, p) = (&self.mechanics, &self.parameters);
        let way_rad = libm::fabs(distance_rad) - SETTLED_RAD;
        if way_rad <= 0.0 {
            return Some(0.0);
        }
        let sign = if distance_rad < 0.0 { -1.0 } else { 1.0 };
        let both = |of_load: f64, of_motor: f64| {
            of_load * (1.0 + sign * p.load_asymmetry) + of_motor * (1.0 + sign * p.motor_asymmetry) * m.ratio
        };
        let motor_nm = m.ratio * p.torque_saturation_nm;
        if motor_nm <= both(p.load.stiction_nm, p.motor.stiction_nm) {
            return None;
        }
        let coulomb_nm = both(p.load.coulomb_nm, p.motor.coulomb_nm);
        let inertia_kg_m2 = m.load_inertia_kg_m2 + m.ratio * m.ratio * m.motor_inertia_kg_m2;
        let viscous = m.load_friction_nm_s_rad + m.ratio * m.ratio * m.motor_friction_nm_s_rad;
        let stretch = |friction_nm_s_rad, torque_nm| Stretch { inertia_kg_m2, friction_nm_s_rad, torque_nm };
        let (faster, slower) =
            (stretch(-viscous, motor_nm - coulomb_nm), stretch(viscous, motor_nm + coulomb_nm));
        let rest_rad = way_rad + SETTLED_RAD + OVERSHOOT_RAD;
        // Without friction the motor stops at this speed after the whole way.
        let bound_rad_s = libm::sqrt(2.0 * rest_rad * slower.torque_nm / inertia_kg_m2)
            + viscous * rest_rad / inertia_kg_m2;
        let top_rad_s = if viscous > 0.0 { faster.torque_nm / viscous } else { f64::INFINITY };
        let highest_rad_s = bound_rad_s.min(top_rad_s * (1.0 - 1e-12));
        let peak_rad_s =
            bisected(highest_rad_s, |v_rad_s| faster.until(v_rad_s).1 + slower.until(v_rad_s).1 < rest_rad);
        let entry_rad_s = slower.speed_rad_s(SETTLED_RAD + OVERSHOOT_RAD, highest_rad_s);
        let moving_s = if entry_rad_s < peak_rad_s {
            faster.until(peak_rad_s).0 + slower.until(peak_rad_s).0 - slower.until(entry_rad_s).0
        } else {
            faster.until(faster.speed_rad_s(way_rad, highest_rad_s)).0
        };
        Some(delay_s + p.current_lag_s + moving_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Mechanics;
    use crate::backlash_shaft::{ShaftParameters, StribeckParameters};

    const DISTANCE_RAD: f64 = core::f64::consts::FRAC_PI_2;

    fn minimum_s(mechanics: Mechanics, parameters: ShaftParameters) -> Option<f64> {
        let plant = BacklashShaft::new(mechanics, parameters, 16).expect("valid plant");
        plant.minimum_settle_time_s(-DISTANCE_RAD, 1e-3)
    }

    /// The minima that collocation finds with shaft and gap.
    #[test]
    fn minima_are_those_of_the_collocation() {
        let table = include_str!("../../../../benchmarks/minimum-time/minimum-time.csv");
        let mut lines = table.lines();
        let columns: Vec<_> = lines.next().expect("a header").split(',').collect();
        let place = |name| columns.iter().position(|column| *column == name).expect("a column");
        let (limit, settle) = (place("torque_limit_nm"), place("settle_s"));
        let mut rows = 0;
        for line in lines {
            let fields: Vec<f64> = line.split(',').map(|field| field.parse().unwrap_or(f64::NAN)).collect();
            let parameters =
                ShaftParameters { torque_saturation_nm: fields[limit], ..ShaftParameters::paper() };
            let have_s = minimum_s(Mechanics::paper(), parameters).expect("a minimum");
            let error = have_s / fields[settle] - 1.0;
            assert!(error.abs() < 0.02, "{} N m: {have_s} s, {error} off", fields[limit]);
            rows += 1;
        }
        assert_eq!(rows, 7);
    }

    #[test]
    fn without_friction_the_minimum_has_a_closed_form() {
        let no_friction = StribeckParameters { coulomb_nm: 0.0, stiction_nm: 0.0, velocity_rad_s: 1.0 };
        let mechanics =
            Mechanics { load_friction_nm_s_rad: 0.0, motor_friction_nm_s_rad: 0.0, ..Mechanics::paper() };
        let parameters =
            ShaftParameters { load: no_friction, motor: no_friction, ..ShaftParameters::paper() };
        let acceleration = 60.0 / (7.5 + 9.0 * 9.72e-4);
        let (whole_rad, rest_rad) = (DISTANCE_RAD + OVERSHOOT_RAD, SETTLED_RAD + OVERSHOOT_RAD);
        let want_s =
            1.5e-3 + 2.0 * (whole_rad / acceleration).sqrt() - (2.0 * rest_rad / acceleration).sqrt();
        let have_s = minimum_s(mechanics, parameters).expect("a minimum");
        assert!((have_s - want_s).abs() < 1e-9, "have {have_s}, want {want_s} s");
    }

    #[test]
    fn a_motor_weaker_than_stiction_has_no_minimum() {
        let with = |torque_saturation_nm| {
            minimum_s(
                Mechanics::paper(),
                ShaftParameters { torque_saturation_nm, ..ShaftParameters::paper() },
            )
        };
        // Stiction of the load is 3.82 / 3 N m at the motor, that of the motor 0.025 N m.
        assert_eq!(with(1.29), None);
        assert!(with(1.31).is_some_and(|time_s| time_s.is_finite() && time_s > 10.0), "{:?}", with(1.31));
    }
}
