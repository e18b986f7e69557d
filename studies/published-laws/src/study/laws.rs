//! The laws of the comparison: their scenarios, and what is tuned within which range.

use std::vec::Vec;

use battery::campaign::Battery;

/// A parameter that the search may change.
#[derive(Debug, Clone, Copy)]
pub struct Tuned {
    /// As in `controller.parameters`.
    pub name: &'static str,
    /// Searched range. The search is uniform in the logarithm, so both ends are positive.
    pub range: [f64; 2],
}

/// A law of the comparison.
#[derive(Debug, Clone, Copy)]
pub struct Law {
    pub name: &'static str,
    /// The scenario with the law's constants.
    pub scenario: &'static str,
    /// Parameters of the search; none if the constants are the paper's.
    pub tuned: &'static [Tuned],
    /// Values of these parameters and of `lightest` for machines of the harder battery, found by `tune --hard`.
    pub hard: &'static [f64],
    /// Whether the law is Lashloop's own.
    pub ours: bool,
}

const fn tuned(name: &'static str, low: f64, high: f64) -> Tuned {
    Tuned { name, range: [low, high] }
}

/// Largest factor of the rates for a light load, tuned after the others for the harder battery.
const LIGHTEST: Tuned = tuned("lightest", 1.0, 2.5);
const BAND: Tuned = tuned("arrival_band_rad", 0.001, 0.02);
const LOAD_FILTER: Tuned = tuned("load_filter_rad_s", 10.0, 300.0);
const MOTOR_FILTER: Tuned = tuned("motor_filter_rad_s", 50.0, 1000.0);
const TWIST_GAIN: Tuned = tuned("twist_gain_nm_rad", 0.1, 10.0);
const TWIST_DAMPING: Tuned = tuned("twist_damping_nm_s_rad", 0.005, 0.3);
const CROSSING: Tuned = tuned("crossing_nm", 0.01, 1.0);
const NOISE: [Tuned; 3] = [
    tuned("noise_disturbance_nm", 1.0, 100.0),
    tuned("noise_motor_nm", 1e-4, 0.1),
    tuned("noise_gap_rad", 1e-4, 0.1),
];

/// All laws, in the order of the table.
pub const LAWS: [Law; 10] = [
    Law {
        name: "pd",
        scenario: include_str!("../../../../scenarios/shaft-pd.toml"),
        tuned: &[],
        hard: &[],
        ours: false,
    },
    Law {
        name: "merzouki",
        scenario: include_str!("../../../../scenarios/shaft-merzouki.toml"),
        tuned: &[],
        hard: &[],
        ours: false,
    },
    Law {
        name: "dead-band-cascade",
        scenario: include_str!("../../scenarios/dead-band-cascade.toml"),
        tuned: &[
            tuned("cascade_rate_1_s", 0.3, 30.0),
            tuned("cascade_speed_rad_s", 0.3, 10.0),
            tuned("cascade_damping", 0.01, 10.0),
            tuned("cascade_gain_nm_s_rad", 0.005, 0.5),
            tuned("cascade_integral_nm_rad", 0.01, 10.0),
            BAND,
            LOAD_FILTER,
            MOTOR_FILTER,
        ],
        hard: &[11.67, 10.0, 10.0, 0.1303, 0.8634, 0.01413, 117.5, 79.23, 1.205],
        ours: false,
    },
    Law {
        name: "switched-gains",
        scenario: include_str!("../../scenarios/switched-gains.toml"),
        tuned: &[
            tuned("switched_gain_nm_rad", 1.0, 100.0),
            tuned("switched_reach_rad", 0.05, 2.0),
            tuned("switched_damping_nm_s_rad", 0.5, 50.0),
            tuned("switched_integral_nm_rad_s", 0.5, 200.0),
            tuned("switched_twist_nm_s_rad", 0.005, 0.3),
            tuned("switched_gap_nm_rad", 0.1, 20.0),
            tuned("switched_gap_nm_s_rad", 0.005, 0.3),
            BAND,
            LOAD_FILTER,
            MOTOR_FILTER,
        ],
        hard: &[40.5, 1.587, 12.34, 1.455, 0.03279, 9.676, 0.01422, 0.004648, 13.98, 387.5, 2.432],
        ours: false,
    },
    Law {
        name: "sliding-mode",
        scenario: include_str!("../../scenarios/sliding-mode.toml"),
        tuned: &[
            tuned("surface_rate_1_s", 0.5, 20.0),
            tuned("surface_speed_rad_s", 0.5, 10.0),
            tuned("sliding_torque_nm", 2.0, 60.0),
            tuned("sliding_layer_rad_s", 0.05, 5.0),
            tuned("sliding_integral_nm_rad", 1.0, 500.0),
            TWIST_GAIN,
            TWIST_DAMPING,
            CROSSING,
            BAND,
            LOAD_FILTER,
            MOTOR_FILTER,
        ],
        hard: &[4.841, 3.758, 60.0, 0.8423, 60.54, 0.1, 0.01231, 0.01278, 0.02, 24.35, 570.6, 2.063],
        ours: false,
    },
    Law {
        name: "adaptive-inverse",
        scenario: include_str!("../../scenarios/adaptive-inverse.toml"),
        tuned: &[
            tuned("adaptive_rate_1_s", 0.5, 20.0),
            tuned("adaptive_speed_rad_s", 0.5, 10.0),
            tuned("adaptive_gain_nm_s_rad", 5.0, 200.0),
            tuned("adaptive_integral_nm_rad", 5.0, 1000.0),
            tuned("adaptive_integral_limit_nm", 3.0, 30.0),
            tuned("adaptation_rate_1_s", 0.1, 100.0),
            TWIST_GAIN,
            TWIST_DAMPING,
            CROSSING,
            BAND,
            LOAD_FILTER,
            MOTOR_FILTER,
        ],
        hard: &[
            2.751, 7.094, 27.76, 100.1, 6.821, 68.84, 0.4381, 0.04127, 0.5954, 0.001833, 25.85, 50.0, 1.037,
        ],
        ours: false,
    },
    Law {
        name: "kalman-inverse",
        scenario: include_str!("../../scenarios/kalman-inverse.toml"),
        tuned: &[
            tuned("load_rate_1_s", 0.5, 20.0),
            tuned("load_speed_rad_s", 0.5, 10.0),
            tuned("load_gain_nm_s_rad", 5.0, 200.0),
            NOISE[0],
            NOISE[1],
            NOISE[2],
            TWIST_GAIN,
            TWIST_DAMPING,
            CROSSING,
            BAND,
            MOTOR_FILTER,
        ],
        hard: &[2.508, 2.495, 51.34, 1.685, 0.03911, 0.0003291, 0.1, 0.065, 0.07216, 0.004123, 103.5, 1.913],
        ours: false,
    },
    Law {
        name: "predictive",
        scenario: include_str!("../../scenarios/predictive.toml"),
        tuned: &[
            tuned("prediction_step_s", 0.003, 0.02),
            tuned("weight_velocity_s2", 1e-3, 1.0),
            tuned("weight_torque_rad2_nm2", 1e-6, 1e-2),
            NOISE[0],
            NOISE[1],
            NOISE[2],
            tuned("hold_damping_nm_s_rad", 0.001, 0.3),
            BAND,
            MOTOR_FILTER,
        ],
        hard: &[0.01787, 0.02569, 2.236e-6, 1.0, 0.005231, 0.02792, 0.01023, 0.001578, 60.1, 1.157],
        ours: false,
    },
    Law {
        name: "backlash-inverse",
        scenario: include_str!("../../../../scenarios/shaft-backlash-inverse.toml"),
        tuned: &[],
        hard: &[],
        ours: true,
    },
    Law {
        name: "braking-curve",
        scenario: include_str!("../../../../scenarios/shaft-braking-curve.toml"),
        tuned: &[tuned("pace", 0.5, 1.6)],
        hard: &[],
        ours: true,
    },
];

impl Law {
    /// The law of this name.
    ///
    /// # Errors
    /// The names that there are.
    pub fn find(name: &str) -> anyhow::Result<Self> {
        LAWS.into_iter().find(|law| law.name == name).ok_or_else(|| {
            let names: Vec<_> = LAWS.iter().map(|law| law.name).collect();
            anyhow::anyhow!("no law {name}: the laws are {}", names.join(", "))
        })
    }

    /// What is searched for a battery.
    #[must_use]
    pub fn searched(&self, battery: Battery) -> Vec<Tuned> {
        let hard = battery == Battery::Hard && !self.ours && !self.tuned.is_empty();
        self.tuned.iter().copied().chain(hard.then_some(LIGHTEST)).collect()
    }
}
