//! The simulated side of the loop: plant, encoders and reference of a scenario.

use std::collections::VecDeque;

use lashloop_protocol::EncoderCounts;
use lashloop_protocol::message::EncoderSample;
use lashloop_protocol::sequence::of_step;

use super::error::RunError;
use super::plant_from_scenario;
use crate::fault::encoder::EncoderFaults;
use crate::fault::motor::MotorFaults;
use crate::fault::plant::PlantFaults;
use crate::record::trace::TraceRow;
use crate::scenario::Scenario;
use crate::scenario::plant::PlantSettings;
use lashloop_plant::backlash_shaft::BacklashShaft;
use lashloop_plant::encoder::Encoder;
use lashloop_plant::reference::Reference;
use lashloop_plant::{AnyPlant, DryFriction, PlantError, TransportDelay, Truth};

/// Separates the noise of the load encoder from that of the motor encoder.
const LOAD_ENCODER_STREAM: u64 = 0x9e37_79b9_7f4a_7c15;

/// Plant, encoders and reference of a scenario, with their state.
pub struct Simulator {
    plant: AnyPlant,
    motor_encoder: Encoder,
    load_encoder: Encoder,
    /// The latest positions of the motor and load encoders, in counts.
    counts: [i64; 2],
    reference: Reference,
    settings: PlantSettings,
    delay: TransportDelay,
    period_s: f64,
    encoder_faults: EncoderFaults,
    motor_faults: MotorFaults,
    plant_faults: PlantFaults,
    /// The parameters after each fault of the plant, with the first step they apply to.
    next_parameters: VecDeque<(u32, BacklashShaft)>,
}

impl Simulator {
    /// The simulator of a scenario at the start of its run.
    ///
    /// # Errors
    /// A parameter of the plant or of an encoder is outside its range.
    pub fn new(scenario: &Scenario) -> Result<Self, RunError> {
        let period_s = scenario.run.control_period_s();
        let plant_faults = PlantFaults::new(scenario);
        let next_parameters = plant_faults.changes(&scenario.plant).into_iter().map(|(step, settings)| {
            plant_from_scenario::changed(&settings, period_s).map(|parameters| (step, parameters))
        });
        let encoders = &scenario.encoders;
        let encoder = |counts_per_rev, seed| -> Result<_, RunError> {
            Ok(Encoder::new(counts_per_rev, encoders.noise_counts, seed)?)
        };
        Ok(Self {
            plant: plant_from_scenario::plant(&scenario.plant, period_s)?,
            motor_encoder: encoder(encoders.motor_counts_per_rev, scenario.run.seed)?,
            load_encoder: encoder(encoders.load_counts_per_rev, scenario.run.seed ^ LOAD_ENCODER_STREAM)?,
            counts: [0; 2],
            reference: scenario.reference.clone(),
            settings: scenario.plant.clone(),
            encoder_faults: EncoderFaults::new(scenario),
            motor_faults: MotorFaults::new(scenario),
            next_parameters: next_parameters.collect::<Result<_, _>>()?,
            plant_faults,
            delay: TransportDelay::new(
                scenario.plant.backlash_shaft.as_ref().map_or(0, |bench| bench.torque_delay_us),
                scenario.run.control_period_us,
            ),
            period_s,
        })
    }

    /// Reads the encoders and the plant's true state. The row has no torque and no estimates yet: they follow from the
    /// exchange.
    ///
    /// # Errors
    /// As [`AnyPlant::set_environment`] and [`AnyPlant::change_parameters`].
    pub fn observe(&mut self, step: u32) -> Result<(EncoderSample, TraceRow), PlantError> {
        let time_s = f64::from(step) * self.period_s;
        while let Some((_, parameters)) = self.next_parameters.pop_front_if(|(from, _)| *from <= step) {
            self.plant.change_parameters(parameters)?;
        }
        if let Some(mut environment) = plant_from_scenario::environment(&self.settings, time_s) {
            let faulty = self.plant_faults.at(step, &self.settings);
            environment.dead_zone_rad += faulty.growth_rad;
            environment.load_torque_nm += faulty.load_torque_nm;
            self.plant.set_environment(environment)?;
        }
        let truth = self.plant.truth();
        let reference_rad = self.reference.position_rad(time_s);
        self.counts = [
            self.motor_encoder.read(truth.motor_position_rad),
            self.load_encoder.read(truth.load_position_rad),
        ];
        let mut sample = EncoderSample {
            sequence: of_step(step),
            motor_counts: EncoderCounts::wrapping(self.counts[0]),
            load_counts: EncoderCounts::wrapping(self.counts[1]),
            reference_rad: reference_rad as f32,
        };
        self.encoder_faults.apply(step, &mut sample);
        Ok((sample, row(&truth, time_s, reference_rad)))
    }

    /// Checks that a drive can start with this sample, the last one observed: its readings must be the encoders' positions,
    /// without a wraparound.
    ///
    /// # Errors
    /// The encoder that has turned too far, faults of encoders included.
    pub fn check_start(&self, sample: &EncoderSample) -> Result<(), RunError> {
        let readings = [sample.motor_counts, sample.load_counts];
        for ((encoder, count), reading) in ["motor", "load"].into_iter().zip(self.counts).zip(readings) {
            let fault = reading.wrapping_sub(EncoderCounts::wrapping(count));
            let counts = count.saturating_add(fault.into());
            if i64::from(EncoderCounts::wrapping(counts).get()) != counts {
                return Err(RunError::TooFarToStart { encoder, counts });
            }
        }
        Ok(())
    }

    /// Advances the plant by a control period. The torque is held for one, beginning after its delay.
    ///
    /// # Errors
    /// As [`AnyPlant::step`]; as a rule the state overflowed.
    pub fn step(&mut self, step: u32, torque_nm: f32) -> Result<(), PlantError> {
        let torque_nm = self.motor_faults.apply(step, torque_nm);
        for (held_nm, held_s) in self.delay.step(torque_nm.into()) {
            self.plant.step(held_nm, held_s)?;
        }
        Ok(())
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
        dead_zone_rad: truth.dead_zone_rad,
        gap_position_rad: truth.gap_position_rad,
        contact: truth.contact.sign(),
        motor_torque_nm: truth.motor_torque_nm,
        load_torque_nm: truth.load_torque_nm,
        load_dry_friction_nm: truth.load_dry_friction_nm,
        motor_dry_friction_nm: truth.motor_dry_friction_nm,
        load_sticks: f64::from(truth.load_friction == DryFriction::Stick),
        motor_sticks: f64::from(truth.motor_friction == DryFriction::Stick),
        stored_energy_j: truth.energy_j(),
        supplied_energy_j: truth.supplied_energy_j,
        dissipated_energy_j: truth.dissipated_energy_j,
        disturbing_torque_nm: truth.disturbing_torque_nm,
        disturbing_torque_estimate_nm: f64::NAN,
        motor_error_rad: f64::NAN,
        estimate_time_s: f64::NAN,
    }
}
