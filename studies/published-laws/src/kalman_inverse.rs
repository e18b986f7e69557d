//! `kalman-inverse`: an inverse of the gap that a two-mode Kalman filter estimates.
//!
//! The estimator is that of the module `two_mode_filter`, after A. Lagerberg, B. Egardt, IEEE Transactions on Control Systems
//! Technology 15 (2007) 483-493. The paper has no controller for this task, so the inverse is the usual one (module
//! `twist_loop`), with every quantity from the filter:
//!
//! ```text
//! om_d = om_r - sat(lambda e_hat, v_max)
//! C_d  = (f_s om_d + k_v (om_d - om_s_hat) + d_hat) / N0
//! ```
//!
//! The estimated disturbing torque d_hat, which contains the dry friction, takes the place of an integral. On arrival 0.3 of
//! C_d remain (module `arrival`).

use lashloop_firmware::control::nominal_model::NominalModel;
use lashloop_firmware::law::{ControlLaw, ControlOutput, DriveParameters, Measurement, ParameterError};

use crate::common::arrival::{Arrival, ArrivalBand, Phase, REMAINING};
use crate::common::twist_loop::{TwistGains, TwistLoop};
use crate::common::two_mode_filter::{FilterNoise, TwoModeFilter};

lashloop_firmware::parameters! {
    /// Gains of the load loop.
    pub struct LoadGains {
        /// lambda, load error to commanded load velocity.
        load_rate_1_s: F32 = 2.5 in 0.0..=1e4, "1/s";
        /// v_max, largest commanded load velocity relative to the reference.
        load_speed_rad_s: F32 = 1.5 in 0.0..=1e4, "rad/s";
        /// k_v, load velocity error to torque at the load.
        load_gain_nm_s_rad: F32 = 30.0 in 0.0..=1e5, "N m s/rad";
    }
}

lashloop_firmware::signals! {
    /// Signals of the law.
    pub struct KalmanSignals {
        /// j_hat, as used in this torque.
        dead_zone_estimate_rad: "rad",
        /// Estimated load velocity.
        load_velocity_estimate_rad_s: "rad/s",
        /// Estimated stiffness.
        stiffness_estimate_nm_rad: "N m/rad",
    }
}

/// The law with its constants and its state.
pub struct KalmanInverse {
    gains: LoadGains,
    twist_loop: TwistLoop,
    filter: TwoModeFilter,
    arrival: Arrival,
    /// Transmitted torque of the last sample (N m).
    transmitted_nm: f32,
}

impl ControlLaw for KalmanInverse {
    const NAME: &'static str = "kalman-inverse";
    type Parameters = (LoadGains, FilterNoise, TwistGains, ArrivalBand, NominalModel);
    type Signals = KalmanSignals;

    fn new(
        (gains, noise, twist, band, model): Self::Parameters,
        drive: &DriveParameters,
    ) -> Result<Self, ParameterError> {
        Ok(Self {
            gains,
            twist_loop: TwistLoop::new(twist, model, drive)?,
            filter: TwoModeFilter::new(noise, model, drive),
            arrival: Arrival::new(band, drive),
            transmitted_nm: 0.0,
        })
    }

    fn step(&mut self, m: &Measurement<f32>) -> ControlOutput<KalmanSignals> {
        let x = self.filter.step(m);
        let (gains, model) = (&self.gains, &self.twist_loop.model);
        self.transmitted_nm = match self.arrival.step(m) {
            Phase::Approaching => {
                let approach_rad_s = (gains.load_rate_1_s * x.load_error_rad)
                    .clamp(-gains.load_speed_rad_s, gains.load_speed_rad_s);
                let wanted_rad_s = m.reference_velocity_rad_s - approach_rad_s;
                let load_nm = model.load_friction_nm_s_rad * wanted_rad_s
                    + gains.load_gain_nm_s_rad * (wanted_rad_s - x.load_velocity_rad_s)
                    + x.disturbance_nm;
                (load_nm / model.reduction_ratio).clamp(-self.twist_loop.limit_nm, self.twist_loop.limit_nm)
            }
            Phase::Arriving => REMAINING * self.transmitted_nm,
            Phase::Holding => self.transmitted_nm,
        };
        let torque_nm = self.twist_loop.torque_nm(
            m,
            x.load_velocity_rad_s,
            self.transmitted_nm,
            x.dead_zone_rad,
            1.0 / x.stiffness_nm_rad,
        );
        ControlOutput {
            torque_nm,
            signals: KalmanSignals {
                dead_zone_estimate_rad: x.dead_zone_rad,
                load_velocity_estimate_rad_s: x.load_velocity_rad_s,
                stiffness_estimate_nm_rad: x.stiffness_nm_rad,
            },
        }
    }
}
