//! The piecewise affine model: prediction over one step, and its derivatives.
//!
//! The rule is the semi-implicit one: velocities first, then positions by the new velocities. It has no damping of its own,
//! and the resonance of motor and shaft stays below a radian per step.

use lashloop_firmware::control::nominal_model::NominalModel;
use nalgebra::{Matrix4, Vector4};

/// Load error e, load velocity om_s, twist z, motor velocity om_e.
pub(super) type State = Vector4<f32>;

/// The model with the estimates of the present sample.
#[derive(Debug, Clone, Copy)]
pub(super) struct Model {
    nominal: NominalModel,
    pub(super) step_s: f32,
    pub(super) stiffness_nm_rad: f32,
    pub(super) dead_zone_rad: f32,
    /// At the load.
    pub(super) disturbance_nm: f32,
    pub(super) reference_rad_s: f32,
}

/// Where the twist is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Mode {
    Gap,
    /// With the sign of the twist.
    Contact(f32),
}

impl Model {
    pub(super) fn new(nominal: &NominalModel, step_s: f32) -> Self {
        Self {
            nominal: *nominal,
            step_s,
            stiffness_nm_rad: nominal.stiffness_nm_rad,
            dead_zone_rad: nominal.dead_zone_rad,
            disturbance_nm: 0.0,
            reference_rad_s: 0.0,
        }
    }

    pub(super) fn mode(&self, x: &State) -> Mode {
        if x.z.abs() > self.dead_zone_rad { Mode::Contact(1.0_f32.copysign(x.z)) } else { Mode::Gap }
    }

    /// Torque at the motor that holds the load against the disturbance.
    pub(super) fn holding_nm(&self) -> f32 {
        self.disturbance_nm / self.nominal.reduction_ratio
    }

    /// Motor velocity that belongs to the reference.
    pub(super) fn motor_reference_rad_s(&self) -> f32 {
        self.nominal.reduction_ratio * self.reference_rad_s
    }

    /// The state after one step under a torque.
    pub(super) fn next(&self, x: &State, torque_nm: f32) -> State {
        let NominalModel { motor_inertia_kg_m2, load_inertia_kg_m2, reduction_ratio, .. } = self.nominal;
        let transmitted_nm = match self.mode(x) {
            Mode::Gap => 0.0,
            Mode::Contact(side) => self.stiffness_nm_rad * (x.z - side * self.dead_zone_rad),
        };
        let load_nm = reduction_ratio * transmitted_nm
            - self.nominal.load_friction_nm_s_rad * x.y
            - self.disturbance_nm;
        let motor_nm = torque_nm - transmitted_nm - self.nominal.motor_friction_nm_s_rad * x.w;
        let load_rad_s = x.y + self.step_s / load_inertia_kg_m2 * load_nm;
        let motor_rad_s = x.w + self.step_s / motor_inertia_kg_m2 * motor_nm;
        State::new(
            x.x + self.step_s * (load_rad_s - self.reference_rad_s),
            load_rad_s,
            x.z + self.step_s * (motor_rad_s - reduction_ratio * load_rad_s),
            motor_rad_s,
        )
    }

    /// Derivatives of the next state by state and torque, in a mode.
    pub(super) fn derivatives(&self, mode: Mode) -> (Matrix4<f32>, Vector4<f32>) {
        let NominalModel { motor_inertia_kg_m2, load_inertia_kg_m2, reduction_ratio, .. } = self.nominal;
        let (h, ratio) = (self.step_s, reduction_ratio);
        let stiffness = if mode == Mode::Gap { 0.0 } else { self.stiffness_nm_rad };
        // Rows of the new velocities over (e, om_s, z, om_e).
        let load = [
            0.0,
            1.0 - h / load_inertia_kg_m2 * self.nominal.load_friction_nm_s_rad,
            h / load_inertia_kg_m2 * ratio * stiffness,
            0.0,
        ];
        let per_motor = h / motor_inertia_kg_m2;
        let motor =
            [0.0, 0.0, -per_motor * stiffness, 1.0 - per_motor * self.nominal.motor_friction_nm_s_rad];
        let mut by_state = Matrix4::identity();
        for column in 0..4 {
            by_state[(1, column)] = load[column];
            by_state[(3, column)] = motor[column];
            by_state[(0, column)] += h * load[column];
            by_state[(2, column)] += h * (motor[column] - ratio * load[column]);
        }
        (by_state, Vector4::new(0.0, 0.0, h * per_motor, per_motor))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As near as single precision over a step of 0.01 allows.
    fn near(have: State, want: State) -> bool {
        (have - want).iter().zip(&want).all(|(error, want)| error.abs() < 2e-3 * (1.0 + want.abs()))
    }

    #[test]
    fn derivatives_are_those_of_the_prediction() {
        let model = Model::new(&NominalModel::default(), 0.008);
        for twist_rad in [0.05, 1.0, -1.0] {
            let x = State::new(0.3, -0.4, twist_rad, 2.0);
            let (by_state, by_torque) = model.derivatives(model.mode(&x));
            let base = model.next(&x, 0.5);
            for (column, want) in by_state.column_iter().enumerate() {
                let mut moved = x;
                moved[column] += 0.01;
                let have = (model.next(&moved, 0.5) - base) / 0.01;
                assert!(near(have, want.into()), "{column}: {have} {want}");
            }
            let have = model.next(&x, 1.5) - base;
            assert!(near(have, by_torque), "{have} {by_torque}");
        }
    }
}
