//! The simulated side of the loop: what the scenario says of plant, encoders and reference, ready to be stepped.

use lashloop_protocol::message::EncoderSample;

use super::RunError;
use crate::encoder::{Encoder, EncoderState};
use crate::plant::hard_coulomb::HardCoulomb;
use crate::plant::smooth::Smooth;
use crate::plant::{Mechanics, ParameterError, PlantError, Profile, ProfileState, Start, Truth};
use crate::record::trace::TraceRow;
use crate::reference::Reference;
use crate::scenario::Scenario;
use crate::scenario::plant::{PlantModel, PlantSettings};

/// Apart, so that the noise of one encoder is not that of the other.
const LOAD_ENCODER_STREAM: u64 = 0x9e37_79b9_7f4a_7c15;

/// Plant, encoders and reference of a scenario, with their state.
pub struct Bench {
    plant: Profile,
    state: ProfileState,
    motor_encoder: (Encoder, EncoderState),
    load_encoder: (Encoder, EncoderState),
    reference: Reference,
    period_s: f64,
}

impl Bench {
    /// The bench of a scenario at the start of its run.
    ///
    /// # Errors
    /// A parameter of the plant or of an encoder is outside its range.
    pub fn new(scenario: &Scenario) -> Result<Self, RunError> {
        let plant = profile(&scenario.plant)?;
        let initial = &scenario.plant.initial;
        let encoders = &scenario.encoders;
        let encoder = |counts_per_rev, seed| -> Result<_, RunError> {
            let encoder = Encoder::new(counts_per_rev, encoders.noise_counts)?;
            Ok((encoder, encoder.initial_state(seed)))
        };
        Ok(Self {
            state: plant.initial_state(Start {
                load_position_rad: initial.load_position_rad,
                load_velocity_rad_s: initial.load_velocity_rad_s,
                motor_position_rad: initial.motor_position_rad,
                motor_velocity_rad_s: initial.motor_velocity_rad_s,
            }),
            plant,
            motor_encoder: encoder(encoders.motor_counts_per_rev, scenario.run.seed)?,
            load_encoder: encoder(encoders.load_counts_per_rev, scenario.run.seed ^ LOAD_ENCODER_STREAM)?,
            reference: scenario.reference.clone(),
            period_s: scenario.run.control_period_s(),
        })
    }

    /// What the encoders read now, and what the record is to know. The torque of the row is still zero and the estimate
    /// still unknown: the drive has not been asked.
    ///
    /// # Errors
    /// As [`Profile::truth`].
    pub fn observe(&mut self, sequence: u32) -> Result<(EncoderSample, TraceRow), PlantError> {
        let truth = self.plant.truth(&self.state)?;
        let time_s = f64::from(sequence) * self.period_s;
        let reference_rad = self.reference.position_rad(time_s);
        let sample = EncoderSample {
            sequence,
            motor_counts: self.motor_encoder.0.step(&mut self.motor_encoder.1, truth.motor_position_rad),
            load_counts: self.load_encoder.0.step(&mut self.load_encoder.1, truth.load_position_rad),
            reference_rad: reference_rad as f32,
        };
        Ok((sample, row(&truth, time_s, reference_rad)))
    }

    /// Holds a torque for one control period.
    ///
    /// # Errors
    /// As [`Profile::step`]: the state left the range of numbers, above all.
    pub fn step(&mut self, torque_nm: f32) -> Result<(), PlantError> {
        self.plant.step(&mut self.state, torque_nm.into(), self.period_s)
    }
}

fn row(truth: &Truth, time_s: f64, reference_rad: f64) -> TraceRow {
    TraceRow {
        time_s,
        reference_rad,
        load_position_rad: truth.load_position_rad,
        load_velocity_rad_s: truth.load_velocity_rad_s,
        motor_position_rad: truth.motor_position_rad,
        motor_velocity_rad_s: truth.motor_velocity_rad_s,
        torque_nm: 0.0,
        transmitted_torque_nm: truth.transmitted_torque_nm,
        twist_rad: truth.twist_rad,
        dead_zone_estimate_rad: f64::NAN,
    }
}

fn profile(settings: &PlantSettings) -> Result<Profile, ParameterError> {
    let mechanics = Mechanics {
        motor_inertia_kg_m2: settings.motor_inertia_kg_m2,
        motor_friction_nm_s_rad: settings.motor_friction_nm_s_rad,
        load_inertia_kg_m2: settings.load_inertia_kg_m2,
        load_friction_nm_s_rad: settings.load_friction_nm_s_rad,
        ratio: settings.reduction_ratio,
        stiffness_nm_rad: settings.stiffness_nm_rad,
        dead_zone_rad: settings.dead_zone_rad,
    };
    Ok(match settings.model {
        PlantModel::Smooth => Profile::Smooth(Smooth::new(mechanics, settings.substeps)?),
        PlantModel::HardCoulomb => {
            let coulomb_nm = settings.load_coulomb_nm.unwrap_or_default();
            Profile::HardCoulomb(HardCoulomb::new(mechanics, coulomb_nm, settings.substeps)?)
        }
    })
}
