//! The four loops of the paper's figures, with any sensors and in either precision.

use lashloop_firmware::law::Real;

use crate::closed_loop::{Sensors, Timing, regulate_to_zero, run};
use crate::paper;
use crate::trajectory::{Row, settle_s, torque_variation_nm};

/// The drive's torque limit of the experiments in N m.
pub(crate) const TORQUE_LIMIT_NM: f64 = 25.0;

const TIMING: Timing = Timing { torque_limit_nm: TORQUE_LIMIT_NM, ..Timing::RECORDED };

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
                run(&paper::smooth(4), paper::START, &law, sensors, regulate_to_zero, TIMING)
            }
            Self::HardCoulombPd | Self::HardCoulombMerzouki => {
                run(&paper::hard_coulomb(4), paper::START, &law, sensors, regulate_to_zero, TIMING)
            }
        }
    }
}

/// The numbers that the paper's figures show.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Measures {
    pub(crate) settle_s: Option<f64>,
    pub(crate) final_error_rad: f64,
    pub(crate) final_estimate_rad: f64,
    pub(crate) largest_torque_nm: f64,
    pub(crate) torque_variation_nm: f64,
}

impl Measures {
    pub(crate) fn of(rows: &[Row]) -> Self {
        let last = rows.last().expect("a trajectory has rows");
        Self {
            settle_s: settle_s(rows),
            final_error_rad: last.truth.load_position_rad,
            final_estimate_rad: last.dead_zone_estimate_rad,
            largest_torque_nm: rows.iter().map(|row| row.torque_nm.abs()).fold(0.0, f64::max),
            torque_variation_nm: torque_variation_nm(rows),
        }
    }
}
