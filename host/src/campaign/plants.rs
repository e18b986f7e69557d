//! Random plants around the nominal backlash shaft.
//!
//! Every parameter of the nominal plant is multiplied by a factor between 0.7 and 1.3. Gap, stiction and encoder resolution
//! have ranges of their own. The reduction ratio is a ratio of tooth counts and stays constant. Each parameter has its own
//! random stream, seeded by its key, and plant i takes the i-th number. A plant therefore depends neither on the number of
//! plants nor on other parameters.

use rand_pcg::Pcg64;
use rand_pcg::rand_core::SeedableRng;
use sha2::{Digest, Sha256};

use lashloop_plant::Mechanics;
use lashloop_plant::backlash_shaft::ShaftParameters;
use lashloop_plant::random;

/// Largest deviation of a parameter from its nominal value, as a fraction.
const TOLERANCE: f64 = 0.3;
/// Dead-zone amplitude j0, in rad.
const DEAD_ZONE_RAD: [f64; 2] = [0.02, 0.4];
/// Stiction over Coulomb friction, F_s / F_c, of load and of motor.
const STICTION_RATIO: [f64; 2] = [1.0, 1.5];
const COUNTS_PER_REV: [f64; 2] = [2_000.0, 10_000.0];

/// A plant and its encoders.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RandomPlant {
    pub mechanics: Mechanics,
    pub parameters: ShaftParameters,
    /// Of both encoders.
    pub counts_per_rev: u32,
}

/// A parameter with a tolerance around its nominal value.
struct Parameter {
    key: &'static str,
    /// One SI unit in the unit of the key.
    per_si: f64,
    of: fn(&mut RandomPlant) -> &mut f64,
}

const fn si(key: &'static str, of: fn(&mut RandomPlant) -> &mut f64) -> Parameter {
    Parameter { key, per_si: 1.0, of }
}

const TOLERATED: [Parameter; 11] = [
    si("plant.load_inertia_kg_m2", |it| &mut it.mechanics.load_inertia_kg_m2),
    si("plant.load_friction_nm_s_rad", |it| &mut it.mechanics.load_friction_nm_s_rad),
    si("plant.motor_inertia_kg_m2", |it| &mut it.mechanics.motor_inertia_kg_m2),
    si("plant.motor_friction_nm_s_rad", |it| &mut it.mechanics.motor_friction_nm_s_rad),
    si("plant.stiffness_nm_rad", |it| &mut it.mechanics.stiffness_nm_rad),
    si("plant.shaft_damping_nm_s_rad", |it| &mut it.parameters.shaft_damping_nm_s_rad),
    si("plant.load_coulomb_nm", |it| &mut it.parameters.load.coulomb_nm),
    si("plant.load_stribeck_rad_s", |it| &mut it.parameters.load.velocity_rad_s),
    si("plant.motor_coulomb_nm", |it| &mut it.parameters.motor.coulomb_nm),
    si("plant.motor_stribeck_rad_s", |it| &mut it.parameters.motor.velocity_rad_s),
    Parameter { key: "plant.current_lag_ms", per_si: 1e3, of: |it| &mut it.parameters.current_lag_s },
];

const DEAD_ZONE: &str = "plant.dead_zone_rad";
const LOAD_STICTION: &str = "plant.load_stiction_nm";
const MOTOR_STICTION: &str = "plant.motor_stiction_nm";
pub(super) const ENCODERS: [&str; 2] = ["encoders.motor_counts_per_rev", "encoders.load_counts_per_rev"];

impl RandomPlant {
    #[must_use]
    pub fn draw(seed: u64, index: u32) -> Self {
        let within = |name, [low, high]: [f64; 2]| low + (high - low) * uniform(seed, name, index);
        let mut plant = Self {
            mechanics: Mechanics::paper(),
            parameters: ShaftParameters::paper(),
            counts_per_rev: within(ENCODERS[0], COUNTS_PER_REV).round() as u32,
        };
        for Parameter { key, of, .. } in &TOLERATED {
            *of(&mut plant) *= within(key, [1.0 - TOLERANCE, 1.0 + TOLERANCE]);
        }
        plant.mechanics.dead_zone_rad = within(DEAD_ZONE, DEAD_ZONE_RAD);
        let ShaftParameters { load, motor, .. } = &mut plant.parameters;
        load.stiction_nm = load.coulomb_nm * within(LOAD_STICTION, STICTION_RATIO);
        motor.stiction_nm = motor.coulomb_nm * within(MOTOR_STICTION, STICTION_RATIO);
        plant
    }

    /// The plant as settings for `lashloop run --set`.
    #[must_use]
    pub fn settings(mut self) -> Vec<String> {
        let tolerated = TOLERATED.iter().map(|Parameter { key, per_si, of }| (*key, *of(&mut self) * per_si));
        let mut settings: Vec<_> = tolerated.map(|(key, value)| format!("{key}={value:?}")).collect();
        for (key, value) in [
            (DEAD_ZONE, self.mechanics.dead_zone_rad),
            (LOAD_STICTION, self.parameters.load.stiction_nm),
            (MOTOR_STICTION, self.parameters.motor.stiction_nm),
        ] {
            settings.push(format!("{key}={value:?}"));
        }
        settings.extend(ENCODERS.map(|key| format!("{key}={}", self.counts_per_rev)));
        settings
    }
}

/// Number `index` of a stream, uniform in [0, 1).
fn uniform(seed: u64, stream: &str, index: u32) -> f64 {
    let name = Sha256::new().chain_update(seed.to_le_bytes()).chain_update(stream).finalize();
    let mut generator = Pcg64::from_seed(name.into());
    generator.advance(index.into());
    random::uniform(&mut generator)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fields(mut plant: RandomPlant) -> Vec<f64> {
        TOLERATED.iter().map(|it| *(it.of)(&mut plant)).collect()
    }

    #[test]
    fn plants_fill_their_ranges_and_do_not_leave_them() {
        let nominal = fields(RandomPlant {
            mechanics: Mechanics::paper(),
            parameters: ShaftParameters::paper(),
            counts_per_rev: 4000,
        });
        let plants: Vec<_> = (0..2000).map(|index| RandomPlant::draw(1, index)).collect();
        let fills = |what: &str, values: Vec<f64>, [low, high]: [f64; 2]| {
            let fraction = |value: f64| (value - low) / (high - low);
            let fractions: Vec<_> = values.into_iter().map(fraction).collect();
            assert!(fractions.iter().all(|fraction| (-1e-12..=1.0 + 1e-12).contains(fraction)), "{what}");
            let mean = fractions.iter().sum::<f64>() / fractions.len() as f64;
            assert!((mean - 0.5).abs() < 0.03, "{what}: mean at {mean} of the range, want 0.5");
            let low = fractions.iter().copied().fold(f64::MAX, f64::min);
            let high = fractions.iter().copied().fold(f64::MIN, f64::max);
            assert!(low < 0.01 && high > 0.99, "{what}: from {low} to {high} of the range");
        };
        for (at, Parameter { key, .. }) in TOLERATED.iter().enumerate() {
            let factors = plants.iter().map(|&plant| fields(plant)[at] / nominal[at]).collect();
            fills(key, factors, [0.7, 1.3]);
        }
        fills("gap", plants.iter().map(|it| it.mechanics.dead_zone_rad).collect(), [0.02, 0.4]);
        fills("counts", plants.iter().map(|it| it.counts_per_rev.into()).collect(), [2e3, 1e4]);
        for side in [|it: &RandomPlant| it.parameters.load, |it: &RandomPlant| it.parameters.motor] {
            let ratios = plants.iter().map(|it| side(it).stiction_nm / side(it).coulomb_nm).collect();
            fills("stiction", ratios, [1.0, 1.5]);
        }
    }

    #[test]
    fn no_two_streams_and_no_two_seeds_are_alike() {
        let plant = RandomPlant::draw(1, 7);
        assert_eq!(plant, RandomPlant::draw(1, 7));
        assert_ne!(plant, RandomPlant::draw(2, 7));
        assert_ne!(plant, RandomPlant::draw(1, 8));
        let drawn: Vec<_> = TOLERATED.iter().map(|it| uniform(1, it.key, 0).to_bits()).collect();
        let mut distinct = drawn.clone();
        distinct.sort_unstable();
        distinct.dedup();
        assert_eq!(distinct.len(), drawn.len());
    }
}
