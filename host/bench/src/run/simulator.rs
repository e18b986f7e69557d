//! The simulated side of the loop: plant, encoders and reference of a scenario.

use std::collections::VecDeque;
use std::sync::Arc;

use lashloop_protocol::EncoderCounts;
use lashloop_protocol::message::EncoderSample;
use lashloop_protocol::sequence::of_step;

use super::error::RunError;
use super::step::{Observation, TraceRow, TruthValues};
use crate::fault::encoder::EncoderFaults;
use crate::fault::motor::MotorFaults;
use crate::fault::plant::PlantFaults;
use crate::scenario::Scenario;
use crate::scenario::plant::PlantSettings;
use crate::scenario::sections::LineSettings;
use lashloop_plant::encoder::Encoder;
use lashloop_plant::reference::Reference;
use lashloop_plant::{Environment, Plant, PlantError, PlantValues, Positions, Signal, TransportDelay};

/// Separates the noise of the load encoder from that of the motor encoder.
const LOAD_ENCODER_STREAM: u64 = 0x9e37_79b9_7f4a_7c15;

/// Separates the line to the motor from the encoders' noise.
const LINE_STREAM: u64 = 0xa076_1d64_78bd_642f;

/// Plant, encoders and reference of a scenario, with their state.
pub struct Simulator {
    plant: Box<dyn Plant>,
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
    /// Torque on top of the drive's, by the step.
    excitation_nm: Arc<[f32]>,
    plant_faults: PlantFaults,
    /// The values of the plant's keys after each fault, with the first step they apply to.
    next_values: VecDeque<(u32, PlantValues)>,
    has_faults: bool,
}

/// The way of torques to the motor: the plant's own delay, and the modelled line.
fn transport_delay(scenario: &Scenario) -> TransportDelay {
    let LineSettings { delay_us, jitter_us, loss } = scenario.line;
    TransportDelay::new(scenario.plant.torque_delay_us() + delay_us, scenario.run.control_period_us)
        .with_variation(jitter_us, loss, scenario.run.seed ^ LINE_STREAM)
}

impl Simulator {
    /// The simulator of a scenario at the start of its run.
    ///
    /// # Errors
    /// A parameter of the plant, as it is or after a fault, or of an encoder is outside its range.
    pub fn new(scenario: &Scenario) -> Result<Self, RunError> {
        let period_s = scenario.run.control_period_s();
        let plant_faults = PlantFaults::new(scenario);
        let settings = &scenario.plant;
        let plant = settings.release(&scenario.run)?;
        let next_values = plant_faults.changes(settings);
        if !next_values.is_empty() {
            // What a fault makes of the plant is checked before the run, on a plant that is not used.
            let mut rehearsal = settings.release(&scenario.run)?;
            for (_, values) in &next_values {
                rehearsal.change_parameters(&settings.with(values, period_s))?;
            }
        }
        let encoders = &scenario.encoders;
        Ok(Self {
            plant,
            motor_encoder: encoders.motor(scenario.run.seed)?,
            load_encoder: encoders.load(scenario.run.seed ^ LOAD_ENCODER_STREAM)?,
            counts: [0; 2],
            reference: scenario.reference.clone(),
            settings: scenario.plant.clone(),
            encoder_faults: EncoderFaults::new(scenario),
            motor_faults: MotorFaults::new(scenario),
            excitation_nm: scenario.excitation_nm.clone(),
            next_values: next_values.into(),
            has_faults: !scenario.faults.is_empty(),
            plant_faults,
            delay: transport_delay(scenario),
            period_s,
        })
    }

    /// Signals of the plant's truth.
    pub fn signals(&self) -> &[Signal] {
        self.plant.signals()
    }

    /// Reads the encoders and the plant's true state.
    ///
    /// # Errors
    /// As [`Plant::set_environment`] and [`Plant::change_parameters`].
    pub fn observe(&mut self, step: u32) -> Result<(EncoderSample, Observation), PlantError> {
        let time_s = f64::from(step) * self.period_s;
        while let Some((_, values)) = self.next_values.pop_front_if(|(from, _)| *from <= step) {
            self.plant.change_parameters(&self.settings.with(&values, self.period_s))?;
        }
        if let Some(environment) = &self.settings.environment {
            let (scheduled, faulty) = (environment.at(time_s), self.plant_faults.environment(step));
            self.plant.set_environment(Environment {
                gap_growth_rad: scheduled.gap_growth_rad + faulty.gap_growth_rad,
                load_torque_nm: scheduled.load_torque_nm + faulty.load_torque_nm,
            })?;
        }
        let positions = self.plant.positions();
        let reference_rad = self.reference.position_rad(time_s);
        self.counts = [
            self.motor_encoder.read(positions.motor_position_rad),
            self.load_encoder.read(positions.load_position_rad),
        ];
        let mut sample = EncoderSample {
            sequence: of_step(step),
            motor_counts: EncoderCounts::wrapping(self.counts[0]),
            load_counts: EncoderCounts::wrapping(self.counts[1]),
            reference_rad: reference_rad as f32,
        };
        self.encoder_faults.apply(step, &mut sample);
        Ok((sample, self.observation(positions, time_s, reference_rad)))
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
    /// As [`Plant::step`]; as a rule the state overflowed.
    pub fn step(&mut self, step: u32, torque_nm: f32) -> Result<(), PlantError> {
        let mut torque_nm = self.motor_faults.apply(step, torque_nm);
        // Not as a zero: -0 + 0 is another number than -0.
        if let Some(excitation_nm) = self.excitation_nm.get(step as usize) {
            torque_nm += excitation_nm;
        }
        for (held_nm, held_s) in self.delay.step(torque_nm.into()) {
            self.plant.step(held_nm, held_s)?;
        }
        Ok(())
    }

    /// Whether a torque acts at once and unchanged, so that it may change within a control period.
    #[must_use]
    pub fn acts_at_once(&self) -> bool {
        self.delay.is_none() && !self.has_faults && self.excitation_nm.is_empty()
    }

    /// Advances the plant by part of a control period, for a simulator that [acts at once](Self::acts_at_once).
    ///
    /// # Errors
    /// As [`Plant::step`].
    pub fn hold(&mut self, torque_nm: f32, held_s: f64) -> Result<(), PlantError> {
        self.plant.step(torque_nm.into(), held_s)
    }

    /// What the encoders read at present.
    #[must_use]
    pub fn positions(&self) -> Positions {
        self.plant.positions()
    }

    /// The present values of [`signals`](Self::signals), and the load position that a run is judged by, in rad.
    pub fn truth(&self, values: &mut [f64]) -> f64 {
        self.plant.truth(values);
        self.plant.judged_load_position_rad()
    }

    /// The state between two steps in numbers, for [`resumed`](Self::resumed); `None` for a scenario with faults, and for a plant
    /// that can't be saved.
    #[must_use]
    pub fn save(&self) -> Option<Vec<f64>> {
        let mut numbers = self.counts.map(|count| count as f64).to_vec();
        self.delay.save(&mut numbers);
        (!self.has_faults && self.plant.save(&mut numbers)).then_some(numbers)
    }

    /// The simulator of the scenario that [`save`](Self::save) gave these numbers for, with `readings` observed steps.
    ///
    /// # Errors
    /// As [`new`](Self::new). `None` if the numbers are those of another scenario.
    pub fn resumed(scenario: &Scenario, readings: u32, numbers: &[f64]) -> Result<Option<Self>, RunError> {
        let mut simulator = Self::new(scenario)?;
        let mut numbers = numbers.iter().copied();
        for count in &mut simulator.counts {
            *count = numbers.next().unwrap_or_default() as i64;
        }
        let Some(delay) = simulator.delay.resumed(&mut numbers) else { return Ok(None) };
        let is_whole = simulator.plant.restore(&mut numbers) && numbers.next().is_none();
        let [motor_encoder, load_encoder] =
            [simulator.motor_encoder, simulator.load_encoder].map(|encoder| encoder.after(readings.into()));
        Ok(is_whole.then_some(Self { delay, motor_encoder, load_encoder, ..simulator }))
    }

    /// The plant's truth, and the columns that every trace has.
    fn observation(&self, positions: Positions, time_s: f64, reference_rad: f64) -> Observation {
        let mut plant: TruthValues = std::iter::repeat_n(f64::NAN, self.plant.signals().len()).collect();
        self.plant.truth(&mut plant);
        let motor_position_rad = positions.motor_position_rad;
        let load_position_rad = self.plant.judged_load_position_rad();
        let row = TraceRow { time_s, reference_rad, load_position_rad, motor_position_rad, torque_nm: 0.0 };
        Observation { row, plant }
    }
}
