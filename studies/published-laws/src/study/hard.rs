//! The laws on the harder battery: constants that follow from the machine that is stated to the drive.
//!
//! Loads there differ by a factor of 400, so no fixed gains serve all of them. Lashloop's `braking-curve` synthesises its
//! gains from the statement; the published laws get theirs by similarity. The tuned values are those at the nominal
//! machine, and a machine multiplies each by powers of
//!
//! ```text
//! J = J_s + N0^2 J_m,   N0,   r = min(sqrt(a / a_nominal), lightest),   a = N0 U / J
//! ```
//!
//! With r at its root a machine with another load is the nominal one in another unit of time. U, K and J_m are stated as
//! nominal in every part of the battery, so time sqrt(J_m / K) of the shaft and the torque limit change nothing. For light
//! loads the shaft sets the pace, so r ends at `lightest`, which is tuned too.

use std::format;
use std::string::String;
use std::vec::Vec;

use battery::plants::RandomPlant;
use lashloop_firmware::control::nominal_model::NominalModel;

use super::laws::Tuned;

const TORQUE_LIMIT_NM: f64 = 20.0;
/// The largest load velocity that is commanded: a part of the drive's `motor_speed_limit_rad_s`, as of `braking-curve`.
const MOTOR_SPEED_RAD_S: f64 = 0.6 * 1000.0;
/// Nominal Coulomb friction of the load (N m), and what else loads an integral, over N0 U; as of `braking-curve`.
const LOAD_COULOMB_NM: f64 = 3.4;
const INTEGRAL_FRICTION: f64 = 1.5;
const INTEGRAL_TORQUE: f64 = 0.02;

/// The mechanics as stated to the drive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Machine {
    ratio: f64,
    /// Of the load with the motor coupled to it.
    inertia_kg_m2: f64,
    /// What an integral may have to carry, at the load.
    carried_nm: f64,
}

impl Machine {
    /// That of a plant; of `None` the nominal one.
    #[must_use]
    pub fn of(plant: Option<&RandomPlant<'_>>) -> Self {
        let nominal = NominalModel::<f64>::default();
        let stated = |name: &str, nominal: f64| {
            plant.and_then(|it| it.number(&format!("controller.parameters.{name}"))).unwrap_or(nominal)
        };
        let ratio = stated("reduction_ratio", nominal.reduction_ratio);
        let load = stated("load_inertia_kg_m2", nominal.load_inertia_kg_m2);
        let motor = stated("motor_inertia_kg_m2", nominal.motor_inertia_kg_m2);
        let coulomb_nm =
            stated("load_coulomb_nm", LOAD_COULOMB_NM) + ratio * stated("motor_coulomb_nm", 0.02);
        Self {
            ratio,
            inertia_kg_m2: load + ratio * ratio * motor,
            carried_nm: INTEGRAL_FRICTION * coulomb_nm + INTEGRAL_TORQUE * ratio * TORQUE_LIMIT_NM,
        }
    }

    /// Tuned values for this machine as settings of a scenario. A value after those is `lightest`.
    #[must_use]
    pub fn settings(&self, tuned: &[Tuned], values: &[f64]) -> Vec<String> {
        let nominal = Self::of(None);
        let [ratio, inertia] = [self.ratio / nominal.ratio, self.inertia_kg_m2 / nominal.inertia_kg_m2];
        let lightest = values.get(tuned.len()).copied().unwrap_or(1.0);
        let rate = (ratio / inertia).sqrt().min(lightest);
        let scaled = |name: &str, value: f64| {
            let powers = |[of_rate, of_inertia, of_ratio]: [i32; 3]| {
                value * rate.powi(of_rate) * inertia.powi(of_inertia) * ratio.powi(of_ratio)
            };
            match name {
                "cascade_speed_rad_s"
                | "surface_speed_rad_s"
                | "adaptive_speed_rad_s"
                | "load_speed_rad_s" => powers([1, 0, 0]).min(MOTOR_SPEED_RAD_S / self.ratio),
                "cascade_rate_1_s"
                | "surface_rate_1_s"
                | "adaptive_rate_1_s"
                | "load_rate_1_s"
                | "sliding_layer_rad_s"
                | "load_filter_rad_s" => powers([1, 0, 0]),
                "adaptive_gain_nm_s_rad" | "load_gain_nm_s_rad" => powers([1, 1, 0]),
                "sliding_torque_nm" | "sliding_integral_nm_rad" | "adaptive_integral_nm_rad" => {
                    powers([2, 1, 0])
                }
                "cascade_gain_nm_s_rad" => powers([1, 1, -2]),
                "cascade_integral_nm_rad" => powers([2, 1, -2]),
                "switched_gain_nm_rad" => powers([2, 1, -1]),
                "switched_damping_nm_s_rad" => powers([1, 1, -1]),
                "switched_integral_nm_rad_s" => powers([3, 1, -1]),
                "adaptive_integral_limit_nm" => value * self.carried_nm / nominal.carried_nm,
                "noise_disturbance_nm" => powers([2, 1, 0]) * rate.sqrt(),
                "weight_velocity_s2" => powers([-2, 0, 0]),
                "weight_torque_rad2_nm2" => powers([-4, -2, 2]),
                _ => value,
            }
        };
        let setting = |(tuned, value): (&Tuned, &f64)| {
            format!("controller.parameters.{}={:?}", tuned.name, scaled(tuned.name, *value))
        };
        tuned.iter().zip(values).map(setting).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::laws::LAWS;
    use super::*;

    #[test]
    fn nominal_machine_has_the_tuned_values() {
        let machine = Machine::of(None);
        for law in LAWS {
            let values: Vec<f64> = law.tuned.iter().map(|tuned| tuned.range[0]).collect();
            let want = law.tuned.iter().map(|tuned| format!("{}={:?}", tuned.name, tuned.range[0]));
            let have = machine.settings(law.tuned, &values);
            assert!(
                have.iter().zip(want).all(|(have, want)| have.ends_with(&want)),
                "{}: {have:?}",
                law.name
            );
        }
    }

    /// With a hundred times the inertia all takes ten times as long, under the same torques.
    #[test]
    fn heavier_machine_is_the_nominal_one_in_slower_time() {
        let nominal = Machine::of(None);
        let heavy = Machine { inertia_kg_m2: 100.0 * nominal.inertia_kg_m2, ..nominal };
        let names = [
            "switched_gain_nm_rad",
            "switched_damping_nm_s_rad",
            "weight_torque_rad2_nm2",
            "load_filter_rad_s",
        ];
        let tuned = names.map(|name| Tuned { name, range: [1.0, 1.0] });
        let values = heavy
            .settings(&tuned, &[2.0; 5])
            .into_iter()
            .map(|it| it.split_once('=').and_then(|(_, value)| value.parse::<f64>().ok()).expect("a number"));
        for (have, want) in values.zip([2.0, 20.0, 2.0, 0.2]) {
            assert!((have - want).abs() < 1e-9, "have {have}, want {want}");
        }
    }
}
