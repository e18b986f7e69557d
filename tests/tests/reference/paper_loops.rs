//! The four loops of the paper's figures, behind any sensors and in any precision.

use lashloop_firmware::control::Real;

use crate::closed_loop::{Row, Sensors, Timing, regulate_to_nought, run};
use crate::paper;

/// The drive's torque limit of the experiments in N m.
pub(crate) const TORQUE_LIMIT_NM: f64 = 25.0;

const TIMING: Timing = Timing { torque_limit_nm: TORQUE_LIMIT_NM, ..Timing::RECORDED };

/// The band the paper's transient times mean, in rad.
const BAND_RAD: f64 = 0.05;

/// One of the four loops.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Loop {
    SmoothPd,
    SmoothMerzouki,
    HardCoulombPd,
    HardCoulombMerzouki,
}

impl Loop {
    pub(crate) const ALL: [Self; 4] =
        [Self::SmoothPd, Self::SmoothMerzouki, Self::HardCoulombPd, Self::HardCoulombMerzouki];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::SmoothPd => "smooth pd",
            Self::SmoothMerzouki => "smooth merzouki",
            Self::HardCoulombPd => "hard-coulomb pd",
            Self::HardCoulombMerzouki => "hard-coulomb merzouki",
        }
    }

    /// 25 s from the paper's start at 1 kHz.
    pub(crate) fn run<F: Real>(self, sensors: impl Sensors<F>) -> Vec<Row> {
        let law = match self {
            Self::SmoothPd | Self::HardCoulombPd => paper::pd::<F>(),
            Self::SmoothMerzouki => paper::merzouki_nominal(TIMING.period_s),
            Self::HardCoulombMerzouki => paper::merzouki_observed(TIMING.period_s),
        };
        match self {
            Self::SmoothPd | Self::SmoothMerzouki => {
                run(&paper::smooth(4), paper::START, &law, sensors, regulate_to_nought, TIMING)
            }
            Self::HardCoulombPd | Self::HardCoulombMerzouki => {
                run(&paper::hard_coulomb(4), paper::START, &law, sensors, regulate_to_nought, TIMING)
            }
        }
    }
}

/// What the paper's figures are read by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Measures {
    /// First sample after the last one outside the band; None if the last is outside.
    pub(crate) settle_s: Option<f64>,
    pub(crate) final_error_rad: f64,
    pub(crate) final_estimate_rad: f64,
    pub(crate) largest_torque_nm: f64,
    /// Sum of |U_k - U_(k-1)|: what noise of the sensors costs.
    pub(crate) torque_variation_nm: f64,
}

impl Measures {
    pub(crate) fn of(rows: &[Row]) -> Self {
        let last = rows.last().expect("a trajectory has rows");
        let outside = rows.iter().rposition(|row| row.truth.load_position_rad.abs() > BAND_RAD);
        let settled = rows.get(outside.map_or(0, |k| k + 1));
        Self {
            settle_s: settled.map(|row| row.time_s),
            final_error_rad: last.truth.load_position_rad,
            final_estimate_rad: last.dead_zone_estimate_rad,
            largest_torque_nm: rows.iter().map(|row| row.torque_nm.abs()).fold(0.0, f64::max),
            torque_variation_nm: rows
                .windows(2)
                .map(|pair| (pair[1].torque_nm - pair[0].torque_nm).abs())
                .sum(),
        }
    }
}

/// Largest distance between the load positions of two runs in rad.
pub(crate) fn load_distance_rad(one: &[Row], other: &[Row]) -> f64 {
    let pairs = one.iter().zip(other);
    pairs.map(|(a, b)| (a.truth.load_position_rad - b.truth.load_position_rad).abs()).fold(0.0, f64::max)
}
