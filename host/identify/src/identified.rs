//! What the motions show: every quantity with its interval, or that they don't show it.

use lashloop_plant::Mechanics;
use lashloop_plant::backlash_shaft::ShaftParameters;
use serde::Serialize;

use crate::errors::{self, EncoderError, TorqueDoubt};
use crate::fit::{Fit, follows};
use crate::parameters::{COUNT, Parameter, Vector};
use crate::prior::Prior;
use crate::quantity::{CONFIDENCE, DEVIATIONS, Estimate, Quantity};
use crate::series::Instruments;
use crate::signs::Directions;

/// Widest interval that is reported, as a factor in either direction: beyond, the motions don't show the quantity.
const WIDEST: f64 = 2.0;
/// Widest interval of a quantity that has no scale of its own.
const WIDEST_FRACTION: f64 = 0.3;

/// The estimates of a drive train.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Identified {
    /// Directions of the encoders.
    pub directions: Directions,
    /// What was given.
    pub instruments: Instruments,
    /// In the order of a table.
    pub quantities: Vec<Quantity>,
    /// Where the errors of motor and load encoder within a turn are from.
    pub encoder_errors: [EncoderError; 2],
    /// What is unknown of the torque.
    pub torque_doubt: TorqueDoubt,
    /// Root mean square of what the model leaves of the counts of motor and load.
    pub residual_counts: [f64; 2],
    /// Root mean square of what step and delay of the torque explain of it.
    pub explained_counts: [f64; 2],
    /// Probability of each interval.
    pub confidence: f64,
    /// The most likely parameters, those that the motions don't show included.
    #[serde(skip)]
    pub mechanics: Mechanics,
    /// As `mechanics`.
    #[serde(skip)]
    pub shaft: ShaftParameters,
}

impl Identified {
    /// Whether the model follows the motions to about the quantisation of the encoders. If not, the drive train is another
    /// one than the model: the intervals are those of the nearest model.
    #[must_use]
    pub fn is_followed(&self) -> bool {
        follows(self.residual_counts, self.explained_counts, self.instruments.noise_counts)
    }

    /// A quantity by its name.
    #[must_use]
    pub fn quantity(&self, name: &str) -> Option<&Quantity> {
        self.quantities.iter().find(|it| it.name == name)
    }

    /// The most likely value of a quantity, whether the motions show it or not.
    #[must_use]
    pub fn likely(&self, name: &str) -> Option<f64> {
        let ShaftParameters { torque_offset_nm, cogging, .. } = self.shaft;
        match name {
            "torque_offset_nm" => return Some(torque_offset_nm),
            "cogging_nm" => return Some(cogging.amplitude_nm),
            "cogging_per_turn" => return Some(cogging.per_turn),
            _ => {}
        }
        let vector = Vector::of(&self.mechanics, &self.shaft);
        DEFINITIONS.iter().find(|it| it.quantity.name == name).map(|it| (it.of)(&vector))
    }

    pub(crate) fn new(fit: &Fit, prior: &Prior, directions: Directions, instruments: &Instruments) -> Self {
        let vector = &fit.point.vector;
        let mechanical = DEFINITIONS.iter().map(|it| it.quantity(fit));
        let quantities: Vec<_> = mechanical.chain(errors::quantities(fit, prior, instruments)).collect();
        let phase = quantities.iter().find(|it| it.name == "cogging_phase_rad").and_then(|it| it.estimate);
        Self {
            directions,
            instruments: *instruments,
            quantities,
            torque_doubt: TorqueDoubt::new(fit, prior, phase),
            encoder_errors: errors::encoder_errors(fit, prior, instruments.encoder_error_rad),
            residual_counts: fit.residual_counts,
            explained_counts: fit.explained_counts,
            confidence: CONFIDENCE,
            mechanics: vector.mechanics(),
            shaft: vector.shaft(),
        }
    }
}

/// How a quantity follows from the parameters.
struct Definition {
    /// Without an estimate.
    quantity: Quantity,
    is_fraction: bool,
    of: fn(&Vector) -> f64,
}

impl Definition {
    fn quantity(&self, fit: &Fit) -> Quantity {
        Quantity { estimate: self.estimate(fit), ..self.quantity.clone() }
    }

    /// In the scale in which the quantity is linear in the elements of the vector.
    fn scaled(&self, vector: &Vector) -> f64 {
        let value = (self.of)(vector);
        if self.is_fraction { value } else { value.ln() }
    }

    fn estimate(&self, fit: &Fit) -> Option<Estimate> {
        const STEP: f64 = 1e-5;
        let vector = &fit.point.vector;
        let middle = self.scaled(vector);
        let mut slopes = [0.0; COUNT];
        for (slope, parameter) in slopes.iter_mut().zip(Parameter::ALL) {
            let mut moved = *vector;
            moved.set(parameter, moved.get(parameter) + STEP);
            *slope = (self.scaled(&moved) - middle) / STEP;
        }
        let mut variance = 0.0;
        for (i, left) in slopes.iter().enumerate() {
            for (j, right) in slopes.iter().enumerate() {
                variance += left * right * fit.covariance[(i, j)];
            }
        }
        let half = DEVIATIONS * variance.max(0.0).sqrt();
        let widest = if self.is_fraction { WIDEST_FRACTION } else { WIDEST.ln() };
        if !half.is_finite() || half > widest {
            return None;
        }
        let back = |scaled: f64| if self.is_fraction { scaled } else { scaled.exp() };
        Some(Estimate { value: back(middle), low: back(middle - half), high: back(middle + half) })
    }
}

/// Declares the quantities, a row each: kind, name, unit, meaning and value.
///
/// | kind | is |
/// |---|---|
/// | `other` | a quantity that the plant has no key for |
/// | `key` | a key of the plant |
/// | `shared` | a key of the plant that is a parameter of the drive's laws by the same name |
/// | `fraction` | a key of the plant without a scale of its own |
macro_rules! quantities {
    ($($kind:ident $name:literal $unit:literal $meaning:literal => |$it:ident| $value:expr;)+) => {
        const DEFINITIONS: &[Definition] = &[$({
            let (plant_key, drive_parameter, is_fraction) = quantities!(@$kind $name);
            let (name, unit, meaning) = ($name, $unit, $meaning);
            let quantity = Quantity { name, unit, meaning, estimate: None, plant_key, drive_parameter };
            Definition { quantity, is_fraction, of: |$it| $value }
        }),+];
    };
    (@other $name:literal) => { (None, None, false) };
    (@key $name:literal) => { (Some($name), None, false) };
    (@shared $name:literal) => { (Some($name), Some($name), false) };
    (@fraction $name:literal) => { (Some($name), None, true) };
}

quantities! {
    shared "reduction_ratio" "" "reduction ratio N0" => |it| it.value(Parameter::Ratio);
    other "gap_width_rad" "rad" "gap from flank to flank, at the motor" => |it| 2.0 * it.value(Parameter::DeadZone);
    shared "dead_zone_rad" "rad" "half gap j0, at the motor" => |it| it.value(Parameter::DeadZone);
    shared "stiffness_nm_rad" "N m/rad" "stiffness K, at the motor" => |it| it.value(Parameter::Stiffness);
    key "shaft_damping_nm_s_rad" "N m s/rad" "damping c of the shaft" => |it| it.value(Parameter::ShaftDamping);
    shared "motor_inertia_kg_m2" "kg m^2" "inertia J_m of the motor" => |it| it.value(Parameter::MotorInertia);
    shared "motor_friction_nm_s_rad" "N m s/rad" "viscous friction f_m of the motor" => |it| it.value(Parameter::MotorViscous);
    shared "motor_coulomb_nm" "N m" "Coulomb friction of the motor, each way" => |it| it.value(Parameter::MotorCoulomb);
    key "motor_stiction_nm" "N m" "breakaway torque of the motor, each way" => |it| it.shaft().motor.stiction_nm;
    key "motor_stribeck_rad_s" "rad/s" "Stribeck velocity of the motor" => |it| it.value(Parameter::MotorStribeck);
    shared "load_inertia_kg_m2" "kg m^2" "inertia J_s of the load" => |it| it.mechanics().load_inertia_kg_m2;
    shared "load_friction_nm_s_rad" "N m s/rad" "viscous friction f_s of the load" => |it| it.mechanics().load_friction_nm_s_rad;
    shared "load_coulomb_nm" "N m" "Coulomb friction of the load, mean of both ways" => |it| it.shaft().load.coulomb_nm;
    other "load_coulomb_forward_nm" "N m" "Coulomb friction of the load forward" =>
        |it| it.shaft().load.coulomb_nm * (1.0 + it.get(Parameter::LoadAsymmetry));
    other "load_coulomb_backward_nm" "N m" "Coulomb friction of the load backward" =>
        |it| it.shaft().load.coulomb_nm * (1.0 - it.get(Parameter::LoadAsymmetry));
    key "load_stiction_nm" "N m" "breakaway torque of the load, mean of both ways" => |it| it.shaft().load.stiction_nm;
    other "load_stiction_forward_nm" "N m" "breakaway torque of the load forward" =>
        |it| it.shaft().load.stiction_nm * (1.0 + it.get(Parameter::LoadAsymmetry));
    other "load_stiction_backward_nm" "N m" "breakaway torque of the load backward" =>
        |it| it.shaft().load.stiction_nm * (1.0 - it.get(Parameter::LoadAsymmetry));
    key "load_stribeck_rad_s" "rad/s" "Stribeck velocity of the load" => |it| it.shaft().load.velocity_rad_s;
    fraction "load_friction_asymmetry" "" "fraction by which the load's friction is larger forward" =>
        |it| it.get(Parameter::LoadAsymmetry);
    key "current_lag_ms" "ms" "lag T_i of the current loop" => |it| 1e3 * it.value(Parameter::CurrentLag);
    other "inertia_at_motor_kg_m2" "kg m^2" "inertia of motor and load, at the motor" =>
        |it| it.value(Parameter::MotorInertia) + it.value(Parameter::LoadInertia);
}
