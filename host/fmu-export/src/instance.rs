//! The calls of an importer in their order: parameters before the initialization, then steps.
//!
//! Times are those of the importer. Inside, a time is a whole number of nanoseconds since the start, so that sums of steps that
//! drift still meet the ends of the control periods.

use std::path::Path;

use lashloop_bench::scenario::Scenario;

use crate::drive::EXTERNAL;
use crate::error::ExportError;
use crate::interface::Interface;
use crate::plant::{PlantSide, seconds};
use crate::side::Side;
use crate::snapshot::{Phase, Snapshot};
use crate::source::{Source, spelled};
use crate::variable::{Kind, Role, Value, Variable};

/// How far from the end of a control period a time counts as that end, as a fraction of the period.
const SLACK: f64 = 1e-4;

/// An instance of an FMU.
pub struct Instance {
    source: Source,
    token: String,
    interface: Interface,
    values: Vec<Value>,
    phase: Phase,
    start_s: f64,
    at_ns: u64,
    /// The scenario with the parameters as they are.
    scenario: Option<(Vec<String>, Scenario)>,
    side: Option<Side>,
}

impl Instance {
    /// An instance of the FMU with these resources. `token` is what the importer found in the description.
    ///
    /// # Errors
    /// The resources can't be read, or aren't those of the description.
    pub fn new(resources: &Path, token: &str) -> Result<Self, ExportError> {
        let source = Source::in_resources(resources)?;
        let own = source.token();
        if own != token {
            let reason = format!("the description has the token {token:?}, and its resources {own:?}");
            return Err(ExportError::Damaged(reason));
        }
        let interface = Side::interface(&source)?;
        let values = interface.variables.iter().map(|variable| variable.start.clone()).collect();
        let phase = Phase::Instantiated;
        Ok(Self {
            source,
            token: own,
            interface,
            values,
            phase,
            start_s: 0.0,
            at_ns: 0,
            scenario: None,
            side: None,
        })
    }

    /// Sets the time at which the simulation starts, in s.
    ///
    /// # Errors
    /// The initialization has begun, or the time isn't finite.
    pub fn set_start(&mut self, start_s: f64) -> Result<(), ExportError> {
        self.expect(&[Phase::Instantiated], "a start time")?;
        if !start_s.is_finite() {
            return Err(ExportError::Order {
                call: "a start time that isn't finite",
                phase: self.phase.name(),
            });
        }
        self.start_s = start_s;
        self.values[0] = Value::Real(start_s);
        Ok(())
    }

    /// Begins the initialization.
    ///
    /// # Errors
    /// It has begun before.
    pub fn enter_initialization(&mut self) -> Result<(), ExportError> {
        self.expect(&[Phase::Instantiated], "the start of the initialization")?;
        self.phase = Phase::Initializing;
        Ok(())
    }

    /// Ends the initialization: from here on parameters are fixed.
    ///
    /// # Errors
    /// A parameter is out of its range, or plant or drive can't start with them.
    pub fn exit_initialization(&mut self) -> Result<(), ExportError> {
        self.expect(&[Phase::Initializing], "the end of the initialization")?;
        self.build()?;
        self.phase = Phase::Stepping;
        Ok(())
    }

    /// Sets a variable.
    ///
    /// # Errors
    /// It isn't an input or a parameter of this type, or a parameter comes after the initialization.
    pub fn set(&mut self, reference: u32, value: Value) -> Result<(), ExportError> {
        let variable = self.variable(reference, value.kind())?;
        let problem = match variable.role {
            Role::Input => None,
            Role::Parameter if matches!(self.phase, Phase::Instantiated | Phase::Initializing) => None,
            Role::Parameter => Some("is a parameter, and parameters are fixed after the initialization"),
            Role::Output | Role::Time => Some("can't be set"),
        };
        if let Some(problem) = problem {
            let problem = format!("({}) {problem}", variable.name);
            return Err(ExportError::Variable { reference, problem });
        }
        if variable.role == Role::Parameter {
            self.side = None;
        }
        self.values[reference as usize] = value;
        Ok(())
    }

    /// The value of a variable. During the initialization, outputs are those of the parameters as they are.
    ///
    /// # Errors
    /// The FMU has no variable of this reference and type, or a parameter is out of its range.
    pub fn get(&mut self, reference: u32, kind: Kind) -> Result<&Value, ExportError> {
        let role = self.variable(reference, kind)?.role;
        if role == Role::Output && self.phase == Phase::Initializing {
            self.build()?;
        }
        Ok(&self.values[reference as usize])
    }

    /// Advances from `time_s` by `step_s`.
    ///
    /// # Errors
    /// The step doesn't fit the control period, or plant or drive fail.
    pub fn step(&mut self, time_s: f64, step_s: f64) -> Result<(), ExportError> {
        self.expect(&[Phase::Stepping], "a step")?;
        let Some((_, scenario)) = &self.scenario else { return Ok(()) };
        let period_ns = 1000 * u64::from(scenario.run.control_period_us);
        let wrong = |rule| Err(ExportError::Step { step_s, time_s, rule });
        // The FMU counts its own steps: an importer that adds up its steps drifts, and its times are rounded.
        let at_s = self.start_s + seconds(self.at_ns);
        let rounding_s = 4.0 * f64::EPSILON * time_s.abs();
        let until_ns = snapped(seconds(self.at_ns) + step_s, period_ns, rounding_s);
        if until_ns <= self.at_ns || !step_s.is_finite() {
            return wrong("a step must be above 0".to_owned());
        }
        if (time_s - at_s).abs() > 0.5 * step_s || !time_s.is_finite() {
            return wrong(format!("the FMU is at {at_s} s"));
        }
        let inputs = &self.values[self.interface.inputs.clone()];
        if let Some(side) = &mut self.side
            && let Err(error) = side.advance(inputs, until_ns)
        {
            // A drive that ends has switched its torque off.
            self.refresh();
            return Err(error);
        }
        self.at_ns = until_ns;
        self.refresh();
        Ok(())
    }

    /// Ends the simulation.
    ///
    /// # Errors
    /// It hasn't begun.
    pub fn terminate(&mut self) -> Result<(), ExportError> {
        self.expect(&[Phase::Initializing, Phase::Stepping], "the end of the simulation")?;
        self.phase = Phase::Terminated;
        Ok(())
    }

    /// Puts the instance where it was after its creation.
    pub fn reset(&mut self) {
        self.values = self.interface.variables.iter().map(|variable| variable.start.clone()).collect();
        (self.phase, self.start_s, self.at_ns, self.side) = (Phase::Instantiated, 0.0, 0, None);
    }

    /// The state.
    ///
    /// # Errors
    /// The FMU's states can't be saved, as its description says.
    pub fn save(&self) -> Result<Snapshot, ExportError> {
        let plant = self.side.as_ref().map(|side| side.save().ok_or(ExportError::Unsaved)).transpose()?;
        if !self.interface.can_be_saved {
            return Err(ExportError::Unsaved);
        }
        Ok(Snapshot {
            token: self.token.clone(),
            phase: self.phase,
            start_bits: self.start_s.to_bits(),
            at_ns: self.at_ns,
            values: self.values.iter().map(Into::into).collect(),
            plant,
        })
    }

    /// Puts the instance into a state.
    ///
    /// # Errors
    /// The state is another FMU's.
    pub fn restore(&mut self, state: &Snapshot) -> Result<(), ExportError> {
        let values: Vec<Value> = state.values.iter().map(Into::into).collect();
        let fits = values.iter().map(Value::kind).eq(self.interface.variables.iter().map(Variable::kind));
        if state.token != self.token || !fits {
            return Err(ExportError::State("it is another FMU's"));
        }
        let before = std::mem::replace(&mut self.values, values);
        let restored = state.plant.as_ref().map(|plant| {
            let scenario = self.present_scenario()?;
            Ok(Side::Plant(Box::new(PlantSide::restored(scenario, plant)?)))
        });
        self.side = restored.transpose().inspect_err(|_: &ExportError| self.values = before)?;
        self.start_s = f64::from_bits(state.start_bits);
        (self.phase, self.at_ns) = (state.phase, state.at_ns);
        Ok(())
    }

    /// Builds plant or drive with the parameters as they are, unless that was done.
    fn build(&mut self) -> Result<(), ExportError> {
        if self.side.is_some() {
            return Ok(());
        }
        let external = self.interface.variables.iter().position(|variable| variable.name == EXTERNAL);
        let is_external = external.is_some_and(|index| self.values[index] == Value::Boolean(true));
        let part = self.source.part;
        let scenario = self.present_scenario()?;
        self.side = Some(Side::new(part, scenario, is_external)?);
        self.refresh();
        Ok(())
    }

    fn present_scenario(&mut self) -> Result<&Scenario, ExportError> {
        let changes = self.changes();
        let known = self.scenario.take().filter(|(of, _)| *of == changes);
        let known = match known {
            Some(known) => known,
            None => {
                let scenario = self.source.scenario(&changes)?;
                (changes, scenario)
            }
        };
        Ok(&self.scenario.insert(known).1)
    }

    /// The parameters that differ from the scenario, each as `key=value`.
    fn changes(&self) -> Vec<String> {
        let differs = |(variable, value): &(&Variable, &Value)| {
            variable.role == Role::Parameter && variable.name != EXTERNAL && variable.start != **value
        };
        let all = self.interface.variables.iter().zip(&self.values);
        all.filter(differs).map(|(variable, value)| format!("{}={}", variable.name, spelled(value))).collect()
    }

    fn refresh(&mut self) {
        self.values[0] = Value::Real(self.start_s + seconds(self.at_ns));
        let outputs = &mut self.values[self.interface.outputs.clone()];
        if let Some(side) = &self.side {
            side.outputs(outputs);
        }
    }

    fn variable(&self, reference: u32, kind: Kind) -> Result<&Variable, ExportError> {
        let wrong = |problem| ExportError::Variable { reference, problem };
        let variable = self.interface.variables.get(reference as usize);
        let variable = variable.ok_or_else(|| wrong("names no variable of this FMU".to_owned()))?;
        if variable.kind() == kind {
            Ok(variable)
        } else {
            Err(wrong(format!("({}) is of type {:?}, not {kind:?}", variable.name, variable.kind())))
        }
    }

    fn expect(&self, phases: &[Phase], call: &'static str) -> Result<(), ExportError> {
        if phases.contains(&self.phase) {
            Ok(())
        } else {
            Err(ExportError::Order { call, phase: self.phase.name() })
        }
    }
}

/// A time in nanoseconds, on the end of a control period if it is next to one or within `rounding_s` of it. A negative time is 0.
fn snapped(time_s: f64, period_ns: u64, rounding_s: f64) -> u64 {
    let time_ns = (time_s * 1e9).round();
    let end_ns = (time_ns / period_ns as f64).round() * period_ns as f64;
    let is_end = (time_ns - end_ns).abs() <= (SLACK * period_ns as f64).max(rounding_s * 1e9);
    (if is_end { end_ns } else { time_ns }) as u64
}
