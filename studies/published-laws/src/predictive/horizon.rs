//! The torques over the horizon, and their improvement by one Newton step.
//!
//! Along the predicted states the model is affine and the cost quadratic, so the Riccati recursion gives the optimum in one
//! pass. The torque is a scalar: where the optimum leaves the bound, the torque takes the bound and has no feedback.

use nalgebra::{Matrix4, Vector4};

use super::PredictionCost;
use super::model::{Mode, Model, State};

/// Steps of the horizon.
const STEPS: usize = 24;
/// Iterations of the terminal cost's Riccati equation: some ten of its slowest time constants.
const TERMINAL_ITERATIONS: usize = 1500;

/// The horizon with its cost and its torques.
#[derive(Debug, Clone)]
pub(super) struct Horizon {
    /// Weights of a step: load error, load velocity, torque.
    weights: [f32; 3],
    terminal: Matrix4<f32>,
    limit_nm: f32,
    torques_nm: [f32; STEPS],
    states: [State; STEPS + 1],
}

impl Horizon {
    pub(super) fn new(model: &Model, cost: &PredictionCost, limit_nm: f32) -> Self {
        let weights =
            [1.0, cost.weight_velocity_s2, cost.weight_torque_rad2_nm2].map(|weight| weight * model.step_s);
        let (a, b) = model.derivatives(Mode::Contact(1.0));
        let mut terminal = Matrix4::from_diagonal(&Vector4::new(weights[0], weights[1], 0.0, 0.0));
        for _ in 0..TERMINAL_ITERATIONS {
            let spread = terminal * b;
            let by_state = a.transpose() * spread;
            terminal = a.transpose() * terminal * a
                - by_state * by_state.transpose() / (weights[2] + b.dot(&spread));
            terminal[(0, 0)] += weights[0];
            terminal[(1, 1)] += weights[1];
            terminal = (terminal + terminal.transpose()) * 0.5;
        }
        Self { weights, terminal, limit_nm, torques_nm: [0.0; STEPS], states: [State::zeros(); STEPS + 1] }
    }

    /// Improves the torques from this state on, and returns the first one.
    pub(super) fn improve(&mut self, model: &Model, x: &State) -> f32 {
        self.states[0] = *x;
        for step in 0..STEPS {
            self.states[step + 1] = model.next(&self.states[step], self.torques_nm[step]);
        }
        let [of_error, of_velocity, of_torque] = self.weights;
        let holding_nm = model.holding_nm();
        let mut slope = self.terminal * (self.states[STEPS] - self.target(model));
        let mut curvature = self.terminal;
        let mut feedback = [(0.0, Vector4::zeros()); STEPS];
        for step in (0..STEPS).rev() {
            let (x, torque_nm) = (&self.states[step], self.torques_nm[step]);
            let (a, b) = model.derivatives(model.mode(x));
            let spread = curvature * b;
            let by_torque = of_torque * (torque_nm - holding_nm) + b.dot(&slope);
            let by_torque_2 = of_torque + b.dot(&spread);
            let by_state = a.transpose() * spread;
            let free_nm = torque_nm - by_torque / by_torque_2;
            let bounded_nm = free_nm.clamp(-self.limit_nm, self.limit_nm);
            let change_nm = bounded_nm - torque_nm;
            let gain = if bounded_nm == free_nm { -by_state / by_torque_2 } else { Vector4::zeros() };
            feedback[step] = (change_nm, gain);
            slope =
                a.transpose() * slope + by_state * change_nm + gain * (by_torque + by_torque_2 * change_nm);
            curvature = a.transpose() * curvature * a
                + gain * by_state.transpose()
                + by_state * gain.transpose()
                + gain * gain.transpose() * by_torque_2;
            slope.x += of_error * x.x;
            slope.y += of_velocity * (x.y - model.reference_rad_s);
            curvature[(0, 0)] += of_error;
            curvature[(1, 1)] += of_velocity;
            curvature = (curvature + curvature.transpose()) * 0.5;
        }
        let mut x = *x;
        for (step, (change_nm, gain)) in feedback.into_iter().enumerate() {
            let torque_nm = self.torques_nm[step] + change_nm + gain.dot(&(x - self.states[step]));
            self.torques_nm[step] = torque_nm.clamp(-self.limit_nm, self.limit_nm);
            x = model.next(&x, self.torques_nm[step]);
        }
        self.torques_nm[0]
    }

    /// Rest on the reference, with the shaft wound against the disturbance on the flank of the end of the horizon.
    fn target(&self, model: &Model) -> State {
        let end = &self.states[STEPS];
        let side = match model.mode(end) {
            Mode::Contact(side) => side,
            // In the gap the terminal cost has to choose: the flank that drives the load to its reference.
            Mode::Gap => 1.0_f32.copysign(-self.terminal.column(2).dot(&State::new(end.x, end.y, 0.0, 0.0))),
        };
        let twist_rad = side * model.dead_zone_rad + model.holding_nm() / model.stiffness_nm_rad;
        State::new(0.0, model.reference_rad_s, twist_rad, model.motor_reference_rad_s())
    }

    pub(super) fn predicted_error_rad(&self) -> f32 {
        self.states[STEPS].x
    }
}

#[cfg(test)]
mod tests {
    use lashloop_firmware::control::nominal_model::NominalModel;

    use super::*;

    const LIMIT_NM: f32 = 5.0;

    #[test]
    fn load_comes_to_rest_on_its_reference_within_the_torque_limit() {
        let cost = PredictionCost::default();
        let model = Model::new(&NominalModel::default(), cost.prediction_step_s);
        let mut horizon = Horizon::new(&model, &cost, LIMIT_NM);
        let mut x = State::new(-1.5, 0.0, -0.1, 0.0);
        let mut largest_nm = 0.0_f32;
        for _ in 0..750 {
            let torque_nm = horizon.improve(&model, &x);
            largest_nm = largest_nm.max(torque_nm.abs());
            x = model.next(&x, torque_nm);
        }
        assert!(x.x.abs() < 0.005 && x.y.abs() < 0.01, "{x}");
        assert_eq!(largest_nm, LIMIT_NM, "the limit is used and kept");
    }
}
