//! The plant of a scenario with its encoders and the line to the motor: everything that a run has but the drive.
//!
//! A torque is taken at the beginning of a control period and passes the line, with its delay, jitter and loss, and the faults of
//! the motor. The encoders are read at the end of every period. Within a period, counts stay and positions move on.

use lashloop_bench::run::simulator::Simulator;
use lashloop_bench::scenario::Scenario;
use lashloop_protocol::message::EncoderSample;

use crate::error::ExportError;
use crate::interface::Interface;
use crate::source::Source;
use crate::variable::{Role, Value, Variable};

/// Sections whose keys are parameters. The model decides which keys and signals there are, so it isn't one.
const SECTIONS: [&str; 4] = ["plant", "encoders", "line", "run.seed"];
const FIXED: [&str; 1] = ["plant.model"];
/// Those that an FMU of steps of any length has not: with them the torque would reach the motor after a delay.
const FIXED_AT_ANY_STEP: [&str; 5] =
    ["plant.model", "plant.torque_delay_us", "line.delay_us", "line.jitter_us", "line.loss"];

/// A plant in motion.
pub(crate) struct PlantSide {
    simulator: Simulator,
    period_ns: u64,
    /// Control periods that have ended.
    step: u32,
    at_ns: u64,
    /// The latest reading of the encoders.
    sample: EncoderSample,
}

/// Where a plant is, from which it continues bit for bit.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct PlantState {
    step: u32,
    at_ns: u64,
    /// The latest readings of motor and load encoder.
    counts: [i32; 2],
    /// The numbers of the simulator, by their bits.
    bits: Vec<u64>,
}

impl PlantSide {
    pub(crate) fn interface(source: &Source) -> Result<Interface, ExportError> {
        let simulator = Simulator::new(&source.scenario(&[])?)?;
        let torque = Variable::new(
            Role::Input,
            "torque_nm",
            "N m",
            Value::Real(0.0),
            "Torque that the drive commands",
        );
        let output = |name: &str, unit: &str, text: &str| {
            Variable::new(Role::Output, name, unit, Value::Real(0.0), text)
        };
        let counts = |name: &str, text: &str| Variable::new(Role::Output, name, "", Value::Integer(0), text);
        let mut outputs = vec![
            output("motor_position_rad", "rad", "True position of the motor"),
            output("load_position_rad", "rad", "True position at the encoder of the load"),
            output("judged_load_position_rad", "rad", "Position of the load that a run is judged by"),
            counts("motor_counts", "Reading of the motor encoder, in 24 bits"),
            counts("load_counts", "Reading of the load encoder, in 24 bits"),
        ];
        outputs.extend(simulator.signals().iter().map(|signal| output(&signal.name, &signal.unit, "")));
        let (takes_any_step, can_be_saved) = (simulator.acts_at_once(), simulator.save().is_some());
        let fixed: &[&str] = if takes_any_step { &FIXED_AT_ANY_STEP } else { &FIXED };
        let interface = Interface::new(vec![torque], outputs, source.parameters(&SECTIONS, fixed));
        Ok(Interface { takes_any_step, can_be_saved, ..interface })
    }

    /// The plant at the start of the scenario.
    pub(crate) fn new(scenario: &Scenario) -> Result<Self, ExportError> {
        let mut simulator = Simulator::new(scenario)?;
        let (sample, _) =
            simulator.observe(0).map_err(|source| ExportError::Plant { time_s: 0.0, source })?;
        simulator.check_start(&sample)?;
        let period_ns = 1000 * u64::from(scenario.run.control_period_us);
        Ok(Self { simulator, period_ns, step: 0, at_ns: 0, sample })
    }

    /// Holds a torque until this time.
    pub(crate) fn advance(&mut self, torque_nm: f64, until_ns: u64) -> Result<(), ExportError> {
        let is_whole = self.at_ns.is_multiple_of(self.period_ns) && until_ns.is_multiple_of(self.period_ns);
        if !is_whole && !self.simulator.acts_at_once() {
            let rule = format!(
                "the scenario delays or changes torques by the control period of {} s, so steps must be multiples of it",
                seconds(self.period_ns)
            );
            let step_s = seconds(until_ns.saturating_sub(self.at_ns));
            return Err(ExportError::Step { step_s, time_s: seconds(self.at_ns), rule });
        }
        // As on the wire, where a torque has 32 bits.
        let torque_nm = torque_nm as f32;
        while self.at_ns < until_ns {
            let (from_ns, start_ns) = (self.at_ns, u64::from(self.step) * self.period_ns);
            let end_ns = start_ns + self.period_ns;
            let to_ns = until_ns.min(end_ns);
            let moved = if (from_ns, to_ns) == (start_ns, end_ns) {
                self.simulator.step(self.step, torque_nm)
            } else {
                self.simulator.hold(torque_nm, seconds(to_ns - from_ns))
            };
            let failed = |source| ExportError::Plant { time_s: seconds(from_ns), source };
            moved.map_err(failed)?;
            self.at_ns = to_ns;
            if to_ns == end_ns {
                self.step += 1;
                (self.sample, _) = self.simulator.observe(self.step).map_err(failed)?;
            }
        }
        Ok(())
    }

    /// Writes the outputs, in the order of the interface.
    pub(crate) fn outputs(&self, outputs: &mut [Value]) {
        let mut truth = vec![f64::NAN; self.simulator.signals().len()];
        let judged_rad = self.simulator.truth(&mut truth);
        let positions = self.simulator.positions();
        let [motor_counts, load_counts] = self.counts();
        let first = [
            Value::Real(positions.motor_position_rad),
            Value::Real(positions.load_position_rad),
            Value::Real(judged_rad),
            Value::Integer(motor_counts),
            Value::Integer(load_counts),
        ];
        for (output, value) in
            outputs.iter_mut().zip(first.into_iter().chain(truth.into_iter().map(Value::Real)))
        {
            *output = value;
        }
    }

    fn counts(&self) -> [i32; 2] {
        [self.sample.motor_counts.get(), self.sample.load_counts.get()]
    }

    pub(crate) fn save(&self) -> Option<PlantState> {
        let bits = self.simulator.save()?.into_iter().map(f64::to_bits).collect();
        Some(PlantState { step: self.step, at_ns: self.at_ns, counts: self.counts(), bits })
    }

    pub(crate) fn restored(scenario: &Scenario, state: &PlantState) -> Result<Self, ExportError> {
        let numbers: Vec<_> = state.bits.iter().copied().map(f64::from_bits).collect();
        let simulator = Simulator::resumed(scenario, state.step.saturating_add(1), &numbers)?;
        let simulator = simulator.ok_or(ExportError::State("its numbers are those of another plant"))?;
        let [motor_counts, load_counts] =
            state.counts.map(|counts| lashloop_protocol::EncoderCounts::wrapping(counts.into()));
        let sample = EncoderSample { sequence: 0, motor_counts, load_counts, reference_rad: 0.0 };
        let period_ns = 1000 * u64::from(scenario.run.control_period_us);
        Ok(Self { simulator, period_ns, step: state.step, at_ns: state.at_ns, sample })
    }
}

pub(crate) fn seconds(time_ns: u64) -> f64 {
    time_ns as f64 / 1e9
}
