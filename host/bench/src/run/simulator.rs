//! The simulated side of the loop: what the scenario says of plant, encoders and reference, ready to be stepped.

use std::collections::VecDeque;

use lashloop_protocol::EncoderCounts;
use lashloop_protocol::message::EncoderSample;
use lashloop_protocol::sequence::of_step;

use super::{RunError, plant_from_scenario};
use crate::fault::encoder::EncoderFaults;
use crate::fault::motor::MotorFaults;
use crate::fault::plant::PlantFaults;
use crate::record::trace::TraceRow;
use crate::scenario::Scenario;
use crate::scenario::plant::PlantSettings;
use lashloop_plant::backlash_shaft::BacklashShaft;
use lashloop_plant::encoder::Encoder;
use lashloop_plant::reference::Reference;
use lashloop_plant::{AnyPlant, DryFriction, PlantError, Start, TransportDelay, Truth};

/// Apart, so that the noise of one encoder is not that of the other.
const LOAD_ENCODER_STREAM: u64 = 0x9e37_79b9_7f4a_7c15;

/// Plant, encoders and reference of a scenario, with their state.
pub struct Simulator {
    plant: AnyPlant,
    motor_encoder: Encoder,
    load_encoder: Encoder,
    /// Where the encoders of motor and load stood when they were read last.
    counts: [i64; 2],
    reference: Reference,
    settings: PlantSettings,
    delay: TransportDelay,
    period_s: f64,
    sensors: EncoderFaults,
    actuator: MotorFaults,
    gears: PlantFaults,
    /// The parameters after each fault of the plant, with the first step they apply to.
    next_parameters: VecDeque<(u32, BacklashShaft)>,
}

impl Simulator {
    /// The bench of a scenario at the start of its run.
    ///
    /// # Errors
    /// A parameter of the plant or of an encoder is outside its range.
    pub fn new(scenario: &Scenario) -> Result<Self, RunError> {
        let period_s = scenario.run.control_period_s();
        let gears = PlantFaults::new(scenario);
        let next_parameters = gears.changes(&scenario.plant).into_iter().map(|(step, settings)| {
            plant_from_scenario::changed(&settings, period_s).map(|parameters| (step, parameters))
        });
        let initial = &scenario.plant.initial;
        let start = Start {
            load_position_rad: initial.load_position_rad,
            load_velocity_rad_s: initial.load_velocity_rad_s,
            motor_position_rad: initial.motor_position_rad,
            motor_velocity_rad_s: initial.motor_velocity_rad_s,
        };
        let encoders = &scenario.encoders;
        let encoder = |counts_per_rev, seed| -> Result<_, RunError> {
            Ok(Encoder::new(counts_per_rev, encoders.noise_counts, seed)?)
        };
        Ok(Self {
            plant: plant_from_scenario::plant(&scenario.plant, start, period_s)?,
            motor_encoder: encoder(encoders.motor_counts_per_rev, scenario.run.seed)?,
            load_encoder: encoder(encoders.load_counts_per_rev, scenario.run.seed ^ LOAD_ENCODER_STREAM)?,
            counts: [0; 2],
            reference: scenario.reference.clone(),
            settings: scenario.plant.clone(),
            sensors: EncoderFaults::new(scenario),
            actuator: MotorFaults::new(scenario),
            next_parameters: next_parameters.collect::<Result<_, _>>()?,
            gears,
            delay: TransportDelay::new(
                scenario.plant.backlash_shaft.as_ref().map_or(0, |bench| bench.torque_delay_us),
                scenario.run.control_period_us,
            ),
            period_s,
        })
    }

    /// What the encoders read now, and what the record is to know. The torque of the row is still zero and the
    /// estimates still unknown: the drive has not been asked.
    ///
    /// # Errors
    /// As [`AnyPlant::set_environment`] and [`AnyPlant::change_parameters`].
    pub fn observe(&mut self, step: u32) -> Result<(EncoderSample, TraceRow), PlantError> {
        let time_s = f64::from(step) * self.period_s;
        while let Some((_, parameters)) = self.next_parameters.pop_front_if(|(from, _)| *from <= step) {
            self.plant.change_parameters(parameters)?;
        }
        if let Some(mut environment) = plant_from_scenario::environment(&self.settings, time_s) {
            let faulty = self.gears.at(step, &self.settings);
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
        self.sensors.apply(step, &mut sample);
        Ok((sample, row(&truth, time_s, reference_rad)))
    }

    /// Whether a drive can be started with this sample, the last one observed: what it reads is all that the drive gets to
    /// know of where the encoders stand.
    ///
    /// # Errors
    /// Which encoder has turned too far for that, faults of encoders included.
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

    /// Lets a control period pass. The torque is held for one, beginning after its delay.
    ///
    /// # Errors
    /// As [`AnyPlant::step`]: the state left the range of numbers, above all.
    pub fn step(&mut self, step: u32, torque_nm: f32) -> Result<(), PlantError> {
        let torque_nm = self.actuator.apply(step, torque_nm);
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
