//! What the tuning minimises.
//!
//! ```text
//! cost of a plant = settling time + penalties,   cost = mean over the plants + largest of the plants
//! ```
//!
//! On the harder battery the settling time counts in shortest settling times of the plant, because those differ tenfold.
//! The largest stands for the 95 % quantile of few plants. A penalty is a time for each unit beyond a limit; the limits are
//! those that Lashloop's own laws have to meet.

use std::vec::Vec;

use battery::campaign::Battery;

use super::case::{Figures, Plant};

/// Duration of a run of the tuning in s.
pub const DURATION_S: f64 = 15.0;
/// Seed of the tuning plants. The table has other seeds.
pub const SEED: u64 = 1;
/// Random plants besides the nominal one.
const RANDOM_PLANTS: u32 = 12;
/// Random plants of parts of the harder battery, as many in all.
const HARD_PLANTS: [(&str, u32); 2] = [("random-all", 9), ("random-hard", 4)];

/// Overshoot without a penalty (rad), and its price (s/rad).
const OVERSHOOT: [f64; 2] = [0.005, 40.0];
/// Static error without a penalty, where it is more than a count, and its price.
const STATIC_ERROR: [f64; 2] = [0.002, 100.0];
const HUNTING: [f64; 2] = [0.0005, 100.0];
/// Variation of the torque without a penalty (N m), and its price (s/(N m)).
const VARIATION: [f64; 2] = [260.0, 0.002];
/// Load error that counts as much as the whole run in the cost of a run that never settled (rad).
const BAND_RAD: f64 = 0.05;
/// Largest cost of a plant.
const WORST_S: f64 = 1000.0;

/// The plants of the tuning for a battery.
#[must_use]
pub fn plants(battery: Battery) -> Vec<Plant> {
    let seed = SEED;
    match battery {
        Battery::Standard => {
            let random = (0..RANDOM_PLANTS).map(|index| Plant::Random { seed, index });
            std::iter::once(Plant::Nominal).chain(random).collect()
        }
        Battery::Hard => {
            let of = |(part, plants)| (0..plants).map(move |index| Plant::Hard { part, seed, index });
            HARD_PLANTS.into_iter().flat_map(of).collect()
        }
    }
}

/// The cost of a point, plant by plant.
#[derive(Debug, Clone, Copy, Default)]
pub struct Cost {
    sum_s: f64,
    largest_s: f64,
}

impl Cost {
    /// Adds a plant.
    #[must_use]
    pub fn with(self, figures: &Figures) -> Self {
        let cost_s = of_plant_s(figures);
        Self { sum_s: self.sum_s + cost_s, largest_s: self.largest_s.max(cost_s) }
    }

    /// The cost with `plants` plants in all; as long as some are missing, a lower bound of it.
    #[must_use]
    pub fn of_s(self, plants: usize) -> f64 {
        self.sum_s / plants as f64 + self.largest_s
    }
}

fn of_plant_s(figures: &Figures) -> f64 {
    let beyond = |value: f64, [free, price]: [f64; 2]| price * (value - free).max(0.0);
    let settled_s = if figures.settle_time_s.is_finite() {
        figures.over_minimum.unwrap_or(figures.settle_time_s)
    } else {
        DURATION_S * (1.0 + figures.static_error_rad / BAND_RAD)
    };
    let [static_free, static_price] = STATIC_ERROR;
    let cost = settled_s
        + beyond(figures.overshoot_rad, OVERSHOOT)
        + beyond(figures.static_error_rad, [static_free.max(figures.count_rad), static_price])
        + beyond(figures.hunting_rad, HUNTING)
        + beyond(figures.torque_variation_nm, VARIATION);
    cost.min(WORST_S)
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: Figures = Figures {
        settle_time_s: 1.25,
        static_error_rad: 0.0015,
        overshoot_rad: 0.0,
        hunting_rad: 0.0,
        torque_variation_nm: 200.0,
        effort_nm2s: 200.0,
        dead_zone_error_rad: None,
        over_minimum: None,
        count_rad: 0.0016,
    };

    #[test]
    fn run_within_all_limits_costs_its_settling_time() {
        assert_eq!(Cost::default().with(&GOOD).with(&GOOD).of_s(2), 2.5);
    }

    #[test]
    fn worse_plant_costs_more_whichever_figure_is_worse() {
        let worse = [
            Figures { settle_time_s: 1.3, ..GOOD },
            Figures { settle_time_s: f64::INFINITY, ..GOOD },
            Figures { static_error_rad: 0.003, ..GOOD },
            Figures { overshoot_rad: 0.006, ..GOOD },
            Figures { hunting_rad: 0.001, ..GOOD },
            Figures { torque_variation_nm: 300.0, ..GOOD },
            Figures { torque_variation_nm: f64::INFINITY, ..GOOD },
        ];
        for figures in worse {
            let cost = Cost::default().with(&GOOD).with(&figures).of_s(2);
            assert!(cost > 2.5 && cost.is_finite(), "{figures:?}: {cost}");
        }
    }
}
