//! `predictive`: model predictive control with a model of contact and a model of the gap.
//!
//! After P. Rostalski, T. Besselmann, M. Baric, F. van Belzen, M. Morari, "A hybrid approach to modelling, control and state
//! estimation of mechanical systems with backlash", International Journal of Control 80 (2007) 1729-1740: a piecewise affine
//! model with the modes contact and gap, a quadratic cost over a short horizon, a bounded torque, and an estimator for the
//! state. Restated from the idea, with these deviations:
//!
//! - The paper computes the explicit solution off line. Here each period improves the torques of the last one by a single
//!   Newton step over the predicted sequence of modes: a Riccati recursion with the bound of the torque in each step. Its
//!   optimum is local; it does not search other sequences of modes.
//! - The terminal cost is that of linear quadratic control in contact.
//! - The estimator is the module `two_mode_filter`; stiffness, half gap and disturbing torque of the model are its estimates.
//! - On arrival 0.3 of the torque remain (module `arrival`).
//!
//! ```text
//! min sum h (e^2 + q_v (om_s - om_r)^2 + r (U - d / N0)^2) + terminal cost,   |U| <= torque limit
//! ```
//!
//! | module | is |
//! |---|---|
//! | `model` | prediction over one step, and its derivatives |
//! | `horizon` | the torques over the horizon, and their improvement |

mod horizon;
mod model;

use lashloop_firmware::control::nominal_model::NominalModel;
use lashloop_firmware::law::{ControlLaw, ControlOutput, DriveParameters, Measurement, ParameterError};

use crate::common::arrival::{Arrival, ArrivalBand, Phase, REMAINING};
use crate::common::two_mode_filter::{FilterNoise, TwoModeFilter};
use horizon::Horizon;
use model::{Model, State};

lashloop_firmware::parameters! {
    /// Cost and horizon.
    pub struct PredictionCost {
        /// One step of the prediction. The horizon has 24.
        prediction_step_s: F32 = 0.008 in 1e-4..=0.02, "s";
        /// q_v, weight of the load velocity relative to that of the load error.
        weight_velocity_s2: F32 = 0.02 in 0.0..=1e4, "s^2";
        /// r, weight of the torque relative to that of the load error.
        weight_torque_rad2_nm2: F32 = 1e-4 in 1e-9..=1e4, "rad2/N2m2";
        /// Motor velocity to torque while the load is held.
        hold_damping_nm_s_rad: F32 = 0.03 in 0.0..=1.0, "N m s/rad";
    }
}

lashloop_firmware::signals! {
    /// Signals of the law.
    pub struct PredictiveSignals {
        /// j_hat, as used in this torque.
        dead_zone_estimate_rad: "rad",
        /// Estimated load velocity.
        load_velocity_estimate_rad_s: "rad/s",
        /// Load error at the end of the horizon.
        predicted_error_rad: "rad",
    }
}

/// The law with its constants and its state.
pub struct Predictive {
    cost: PredictionCost,
    model: Model,
    filter: TwoModeFilter,
    horizon: Horizon,
    arrival: Arrival,
    torque_nm: f32,
}

impl ControlLaw for Predictive {
    const NAME: &'static str = "predictive";
    type Parameters = (PredictionCost, FilterNoise, ArrivalBand, NominalModel);
    type Signals = PredictiveSignals;

    fn new(
        (cost, noise, band, nominal): Self::Parameters,
        drive: &DriveParameters,
    ) -> Result<Self, ParameterError> {
        ParameterError::at_most(
            "hold_damping_nm_s_rad",
            cost.hold_damping_nm_s_rad,
            nominal.motor_inertia_kg_m2 / drive.period_s(),
            "motor_inertia_kg_m2 divided by the control period",
        )?;
        let model = Model::new(&nominal, cost.prediction_step_s);
        Ok(Self {
            horizon: Horizon::new(&model, &cost, drive.torque_limit_nm),
            model,
            cost,
            filter: TwoModeFilter::new(noise, nominal, drive),
            arrival: Arrival::new(band, drive),
            torque_nm: 0.0,
        })
    }

    fn step(&mut self, m: &Measurement<f32>) -> ControlOutput<PredictiveSignals> {
        let x = self.filter.step(m);
        let model = &mut self.model;
        model.stiffness_nm_rad = x.stiffness_nm_rad;
        model.dead_zone_rad = x.dead_zone_rad;
        model.disturbance_nm = x.disturbance_nm;
        model.reference_rad_s = m.reference_velocity_rad_s;
        let state = State::new(x.load_error_rad, x.load_velocity_rad_s, x.twist_rad, x.motor_velocity_rad_s);
        let phase = self.arrival.step(m);
        if phase == Phase::Approaching {
            self.torque_nm = self.horizon.improve(model, &state);
        } else if phase == Phase::Arriving {
            self.torque_nm *= REMAINING;
        }
        let damping_nm = match phase {
            Phase::Approaching => 0.0,
            Phase::Arriving | Phase::Holding => self.cost.hold_damping_nm_s_rad * x.motor_velocity_rad_s,
        };
        ControlOutput {
            torque_nm: self.torque_nm - damping_nm,
            signals: PredictiveSignals {
                dead_zone_estimate_rad: x.dead_zone_rad,
                load_velocity_estimate_rad_s: x.load_velocity_rad_s,
                predicted_error_rad: self.horizon.predicted_error_rad(),
            },
        }
    }
}
