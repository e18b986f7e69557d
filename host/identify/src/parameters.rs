//! The parameters of a drive train as the fit varies them.
//!
//! The load's quantities are reflected to the motor. The motor's motion then doesn't depend on the reduction ratio, which
//! only scales what the load encoder shows. Positive quantities are varied by their logarithm, so that a step is a factor
//! and no value leaves its range. Errors of torque and encoders are varied as they are.

use lashloop_plant::backlash_shaft::{BacklashShaft, CoggingParameters, ShaftParameters, StribeckParameters};
use lashloop_plant::{Mechanics, ParameterError};

/// Number of parameters.
pub(crate) const COUNT: usize = 23;

/// Place of each parameter in the vector.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Parameter {
    MotorInertia,
    MotorViscous,
    MotorCoulomb,
    /// Logarithm of stiction over Coulomb friction.
    MotorExcess,
    MotorStribeck,
    LoadInertia,
    LoadViscous,
    LoadCoulomb,
    LoadExcess,
    LoadStribeck,
    /// Not a logarithm.
    LoadAsymmetry,
    Ratio,
    Stiffness,
    DeadZone,
    ShaftDamping,
    CurrentLag,
    /// In N m, as all of the torque's errors: not logarithms.
    TorqueOffset,
    /// Amplitude of the part of the cogging that goes with the cosine of the motor's angle times its count per turn.
    CoggingCosine,
    CoggingSine,
    /// In rad: what an eccentric encoder shows on top, as parts of the cosine and the sine of its shaft's angle.
    MotorCosine,
    MotorSine,
    LoadCosine,
    LoadSine,
}

impl Parameter {
    pub(crate) const ALL: [Self; COUNT] = [
        Self::MotorInertia,
        Self::MotorViscous,
        Self::MotorCoulomb,
        Self::MotorExcess,
        Self::MotorStribeck,
        Self::LoadInertia,
        Self::LoadViscous,
        Self::LoadCoulomb,
        Self::LoadExcess,
        Self::LoadStribeck,
        Self::LoadAsymmetry,
        Self::Ratio,
        Self::Stiffness,
        Self::DeadZone,
        Self::ShaftDamping,
        Self::CurrentLag,
        Self::TorqueOffset,
        Self::CoggingCosine,
        Self::CoggingSine,
        Self::MotorCosine,
        Self::MotorSine,
        Self::LoadCosine,
        Self::LoadSine,
    ];
    /// Cosine and sine of the cogging.
    pub(crate) const COGGING: [Self; 2] = [Self::CoggingCosine, Self::CoggingSine];
    /// Cosine and sine of the eccentricity of motor and load encoder.
    pub(crate) const OF_ENCODERS: [[Self; 2]; 2] =
        [[Self::MotorCosine, Self::MotorSine], [Self::LoadCosine, Self::LoadSine]];

    /// Whether it is an error of torque or encoder, in its own unit and around 0.
    pub(crate) fn is_error(self) -> bool {
        self as usize >= Self::TorqueOffset as usize
    }

    fn is_logarithm(self) -> bool {
        !self.is_error() && self != Self::LoadAsymmetry
    }

    fn is_logarithm_of_torque(self) -> bool {
        self.is_logarithm() && !matches!(self, Self::MotorExcess | Self::LoadExcess)
    }

    /// The element after a step of the linearised fit. The equations of motion are linear in inertias, stiffness and
    /// frictions, so a step of a logarithm is taken as one of the quantity itself, in fractions of it.
    pub(crate) fn moved(self, value: f64, step: f64) -> f64 {
        if self.is_logarithm_of_torque() { value + step.max(-0.6).ln_1p() } else { value + step }
    }

    /// The step that leads from one value to another.
    pub(crate) fn step_between(self, from: f64, to: f64) -> f64 {
        if self.is_logarithm_of_torque() { (to - from).exp_m1() } else { to - from }
    }

    /// Range of the vector's element around the start.
    pub(crate) fn limits(self, start: f64) -> [f64; 2] {
        match self {
            Self::MotorExcess | Self::LoadExcess => [0.0, 1.0],
            Self::LoadAsymmetry => [-0.7, 0.7],
            Self::MotorStribeck | Self::LoadStribeck | Self::CurrentLag => [start - 2.0, start + 2.0],
            it if it.is_error() => [f64::NEG_INFINITY, f64::INFINITY],
            _ => [start - 4.0, start + 4.0],
        }
    }
}

/// Values of all parameters, in the scale of the fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Vector {
    elements: [f64; COUNT],
    /// Periods of the cogging per turn of the motor. It isn't varied: the fit is repeated with another one.
    pub(crate) cogging_per_turn: u32,
}

impl Vector {
    pub(crate) fn of(mechanics: &Mechanics, shaft: &ShaftParameters) -> Self {
        let ln = |value: f64, least: f64| value.max(least).ln();
        let ratio = mechanics.ratio;
        let excess = |it: &StribeckParameters| (it.stiction_nm / it.coulomb_nm.max(1e-9)).max(1.0).ln();
        let known = [
            ln(mechanics.motor_inertia_kg_m2, 1e-9),
            ln(mechanics.motor_friction_nm_s_rad, 1e-7),
            ln(shaft.motor.coulomb_nm, 1e-6),
            excess(&shaft.motor),
            ln(shaft.motor.velocity_rad_s, 1e-4),
            ln(mechanics.load_inertia_kg_m2 / ratio.powi(2), 1e-12),
            ln(mechanics.load_friction_nm_s_rad / ratio.powi(2), 1e-9),
            ln(shaft.load.coulomb_nm / ratio, 1e-8),
            excess(&shaft.load),
            ln(shaft.load.velocity_rad_s * ratio, 1e-4),
            shaft.load_asymmetry,
            ln(ratio, 1e-3),
            ln(mechanics.stiffness_nm_rad, 1e-6),
            ln(mechanics.dead_zone_rad, 1e-6),
            ln(shaft.shaft_damping_nm_s_rad, 1e-7),
            ln(shaft.current_lag_s, 1e-5),
        ];
        let mut elements = [0.0; COUNT];
        elements[..known.len()].copy_from_slice(&known);
        elements[Parameter::TorqueOffset as usize] = shaft.torque_offset_nm;
        Self { elements, cogging_per_turn: 1 }
    }

    pub(crate) fn get(&self, parameter: Parameter) -> f64 {
        self.elements[parameter as usize]
    }

    pub(crate) fn value(&self, parameter: Parameter) -> f64 {
        let element = self.get(parameter);
        if parameter.is_logarithm() { element.exp() } else { element }
    }

    pub(crate) fn set(&mut self, parameter: Parameter, value: f64) {
        self.elements[parameter as usize] = value;
    }

    /// Keeps every element within its range around a start.
    pub(crate) fn clamp(&mut self, start: &Self) {
        for parameter in Parameter::ALL {
            let [low, high] = parameter.limits(start.get(parameter));
            self.set(parameter, self.get(parameter).clamp(low, high));
        }
    }

    pub(crate) fn mechanics(&self) -> Mechanics {
        let ratio = self.value(Parameter::Ratio);
        Mechanics {
            motor_inertia_kg_m2: self.value(Parameter::MotorInertia),
            motor_friction_nm_s_rad: self.value(Parameter::MotorViscous),
            load_inertia_kg_m2: self.value(Parameter::LoadInertia) * ratio * ratio,
            load_friction_nm_s_rad: self.value(Parameter::LoadViscous) * ratio * ratio,
            ratio,
            stiffness_nm_rad: self.value(Parameter::Stiffness),
            dead_zone_rad: self.value(Parameter::DeadZone),
        }
    }

    pub(crate) fn shaft(&self) -> ShaftParameters {
        let stribeck = |coulomb_nm: f64, excess, velocity_rad_s| StribeckParameters {
            coulomb_nm,
            stiction_nm: coulomb_nm * self.value(excess),
            velocity_rad_s,
        };
        let ratio = self.value(Parameter::Ratio);
        let load_nm = self.value(Parameter::LoadCoulomb) * ratio;
        let load_rad_s = self.value(Parameter::LoadStribeck) / ratio;
        let [motor_nm, motor_rad_s] =
            [Parameter::MotorCoulomb, Parameter::MotorStribeck].map(|it| self.value(it));
        ShaftParameters {
            shaft_damping_nm_s_rad: self.value(Parameter::ShaftDamping),
            load: stribeck(load_nm, Parameter::LoadExcess, load_rad_s),
            load_asymmetry: self.value(Parameter::LoadAsymmetry),
            motor: stribeck(motor_nm, Parameter::MotorExcess, motor_rad_s),
            current_lag_s: self.value(Parameter::CurrentLag),
            torque_offset_nm: self.value(Parameter::TorqueOffset),
            cogging: CoggingParameters {
                amplitude_nm: self.get(Parameter::CoggingCosine).hypot(self.get(Parameter::CoggingSine)),
                per_turn: f64::from(self.cogging_per_turn),
            },
            torque_saturation_nm: *ShaftParameters::TORQUE_SATURATION_NM.end(),
            ..ShaftParameters::paper()
        }
    }

    /// Without cogging.
    pub(crate) fn smooth(&self) -> Self {
        let mut smooth = *self;
        Parameter::COGGING.into_iter().for_each(|it| smooth.set(it, 0.0));
        smooth
    }

    /// The plant model with these parameters.
    pub(crate) fn plant(&self, substeps: u32) -> Result<BacklashShaft, ParameterError> {
        BacklashShaft::new(self.mechanics(), self.shaft(), substeps)
    }
}
