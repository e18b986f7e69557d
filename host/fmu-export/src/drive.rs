//! The drive of a scenario: its firmware in this process, set up as for a run in lockstep, and the reference.

use lashloop::Bench;
use lashloop_bench::device::Device;
use lashloop_bench::run::setup;
use lashloop_bench::run::takes_torque;
use lashloop_bench::scenario::Scenario;
use lashloop_bench::supervisor::Supervisor;
use lashloop_bench::timing::ClockName;
use lashloop_link::TimeBase;
use lashloop_plant::Signal;
use lashloop_protocol::EncoderCounts;
use lashloop_protocol::enums::{ParameterValue, State};
use lashloop_protocol::message::{EncoderSample, FaultReport, TorqueAnswer};
use lashloop_protocol::parameter_names::{
    BENCH_SAMPLE_EVERY, CONTROLLER, LOAD_COUNTS_PER_REV, MOTOR_COUNTS_PER_REV, PERIOD_US, SAMPLE_SOURCE,
    WATCHDOG_US,
};
use lashloop_session::{Exchange, Parameter, Session};

use crate::error::ExportError;
use crate::interface::Interface;
use crate::plant::seconds;
use crate::source::Source;
use crate::variable::{Role, Value, Variable};

/// Sections whose keys are parameters, besides the parameters of the law.
const SECTIONS: [&str; 3] = ["reference", "encoders.motor_counts_per_rev", "encoders.load_counts_per_rev"];
/// The profile decides which keys there are.
const FIXED: [&str; 3] = ["reference.profile", "reference.file", "reference.interpolation"];
/// Parameters of the drive that keys of the scenario set, or the bench itself.
const SET_ELSEWHERE: [&str; 7] = [
    CONTROLLER,
    PERIOD_US,
    MOTOR_COUNTS_PER_REV,
    LOAD_COUNTS_PER_REV,
    WATCHDOG_US,
    SAMPLE_SOURCE,
    BENCH_SAMPLE_EVERY,
];
/// Parameter of the FMU: the reference is the input, not that of the scenario.
pub(crate) const EXTERNAL: &str = "external_reference";
const DEVICE: &str = "inproc";

/// A drive that runs.
pub(crate) struct Drive {
    device: Device,
    scenario: Scenario,
    period_ns: u64,
    /// Samples that the drive has answered.
    step: u32,
    is_external: bool,
    torque_nm: f32,
    reference_rad: f64,
    signals: Vec<f64>,
}

impl Drive {
    pub(crate) fn interface(source: &Source) -> Result<Interface, ExportError> {
        let scenario = source.scenario(&[])?;
        let (device, signals) = open(&scenario)?;
        let takes_torque = takes_torque(&scenario, &device.session);
        let meaning = if takes_torque {
            "Reference, which the law takes as a torque"
        } else {
            "Commanded position of the load"
        };
        let counts = |name, text| Variable::new(Role::Input, name, "", Value::Integer(0), text);
        let real = |role, name: &str, unit: &str, text: &str| {
            Variable::new(role, name, unit, Value::Real(0.0), text)
        };
        let inputs = vec![
            counts("motor_counts", "Reading of the motor encoder, in 24 bits"),
            counts("load_counts", "Reading of the load encoder, in 24 bits"),
            real(Role::Input, "reference_rad", "rad", &format!("{meaning}, with {EXTERNAL} = true")),
        ];
        let mut outputs = vec![
            real(Role::Output, "torque_nm", "N m", "Torque that the drive commands"),
            real(
                Role::Output,
                "sent_reference_rad",
                "rad",
                &format!(
                    "{meaning}, as the drive has received it; that of the scenario before the first step"
                ),
            ),
        ];
        let of_drive = signals
            .iter()
            .map(|signal| real(Role::Output, &format!("drive.{}", signal.name), &signal.unit, ""));
        outputs.extend(of_drive);
        let text = "Whether the reference is the input reference_rad, not that of the scenario";
        let mut parameters = vec![Variable::new(Role::Parameter, EXTERNAL, "", Value::Boolean(false), text)];
        parameters.extend(source.parameters(&SECTIONS, &FIXED));
        parameters.extend(of_law(&scenario, &device.session));
        Ok(Interface::new(inputs, outputs, parameters))
    }

    /// The drive at the start of the scenario.
    pub(crate) fn new(scenario: Scenario, is_external: bool) -> Result<Self, ExportError> {
        let (mut device, signals) = open(&scenario)?;
        device.session.start().map_err(|source| device.explain(source))?;
        let period_ns = 1000 * u64::from(scenario.run.control_period_us);
        let reference_rad = scenario.reference.position_rad(0.0);
        let signals = vec![0.0; signals.len()];
        Ok(Self { device, scenario, period_ns, step: 0, is_external, torque_nm: 0.0, reference_rad, signals })
    }

    /// Takes the readings of a control period: `inputs` in the order of the interface.
    pub(crate) fn advance(&mut self, inputs: &[Value], until_ns: u64) -> Result<(), ExportError> {
        let at_ns = u64::from(self.step) * self.period_ns;
        let time_s = seconds(at_ns);
        if until_ns != at_ns + self.period_ns {
            let (step_s, period_s) = (seconds(until_ns.saturating_sub(at_ns)), seconds(self.period_ns));
            let rule = format!(
                "the drive takes one sample in each control period, so every step must be {period_s} s"
            );
            return Err(ExportError::Step { step_s, time_s, rule });
        }
        let [motor_counts, load_counts, reference] = inputs else { return Ok(()) };
        let counts = |value: &Value| EncoderCounts::wrapping(value.integer().into());
        let time_of_run_s = f64::from(self.step) * self.scenario.run.control_period_s();
        self.reference_rad = if self.is_external {
            reference.real()
        } else {
            self.scenario.reference.position_rad(time_of_run_s)
        };
        let sample = EncoderSample {
            sequence: 0,
            motor_counts: counts(motor_counts),
            load_counts: counts(load_counts),
            reference_rad: self.reference_rad as f32,
        };
        let answer = self.exchange(&sample, time_s)?;
        self.torque_nm = answer.torque_nm;
        // The telemetry of a sample follows its torque, as does the report of a fault.
        self.read_pending()?;
        if answer.status.state != State::Running {
            self.torque_nm = 0.0;
            let reason = match &self.device.session.line.fault {
                Some(fault) => fault_text(fault),
                None => format!("its state is {}", answer.status.state),
            };
            return Err(ExportError::NoTorque { time_s, reason });
        }
        if let Some(telemetry) = &self.device.session.line.telemetry {
            for (signal, sent) in self.signals.iter_mut().zip(telemetry.values.as_slice()) {
                *signal = f64::from(*sent);
            }
        }
        self.step += 1;
        Ok(())
    }

    fn exchange(&mut self, sample: &EncoderSample, time_s: f64) -> Result<TorqueAnswer, ExportError> {
        let session = &mut self.device.session;
        let deadline = session.line.now() + self.scenario.link.answer_timeout();
        let reason = match session.exchange(self.step, sample, deadline) {
            Ok(Exchange::Answered(answer)) => return Ok(answer),
            Ok(Exchange::Faulted(fault)) => fault_text(&fault),
            Ok(Exchange::Unanswered | Exchange::Rejected) => "it doesn't answer".to_owned(),
            Err(source) => return Err(self.device.explain(source).into()),
        };
        self.torque_nm = 0.0;
        Err(ExportError::NoTorque { time_s, reason })
    }

    fn read_pending(&mut self) -> Result<(), ExportError> {
        let line = &mut self.device.session.line;
        let now = line.now();
        line.wait(now, |_| None::<()>)
            .map(|_| ())
            .map_err(|source| self.device.connection.explain(source).into())
    }

    /// Writes the outputs, in the order of the interface.
    pub(crate) fn outputs(&self, outputs: &mut [Value]) {
        let sent_rad = f64::from(self.reference_rad as f32);
        let first = [f64::from(self.torque_nm), sent_rad];
        for (output, value) in outputs.iter_mut().zip(first.iter().chain(&self.signals)) {
            *output = Value::Real(*value);
        }
    }
}

fn fault_text(fault: &FaultReport) -> String {
    format!("it latched {} (value {}, limit {})", fault.code, fault.value, fault.limit)
}

/// A drive with the settings of the scenario, and the signals of its telemetry, which comes with every sample.
fn open(scenario: &Scenario) -> Result<(Device, Vec<Signal>), ExportError> {
    let mut scenario = scenario.clone();
    scenario.telemetry.every_steps = 1;
    // For drives in processes: this one needs no thread, and leaves none behind in the importer.
    let supervisor = Supervisor::without_signals(None).map_err(lashloop::Error::Thread)?;
    let choice = Bench::new().device(DEVICE)?;
    let mut device = Device::open(&choice, scenario.link.baud, &supervisor)?;
    device.session.line.set_time_base(TimeBase::Virtual);
    let signals = setup::set_up(&mut device, &scenario, ClockName::Lockstep)?;
    Ok((device, signals))
}

/// The parameters of the law in force, by the keys that a scenario sets them by.
fn of_law(scenario: &Scenario, session: &Session) -> Vec<Variable> {
    let law = session.laws.iter().find(|law| law.name == scenario.controller.name).map(|law| law.index);
    let is_of_law = |parameter: &&Parameter| {
        law.is_some_and(|law| parameter.laws.contains(law)) && !SET_ELSEWHERE.contains(&&*parameter.name)
    };
    let variable = |parameter: &Parameter| {
        let start = match session.in_force(parameter) {
            // The shortest number that the drive takes as this one: 0.01, not 0.009999999776482582.
            ParameterValue::F32(number) => Value::Real(number.to_string().parse().unwrap_or(number.into())),
            ParameterValue::U32(number) => Value::Integer(number.try_into().ok()?),
            ParameterValue::Unknown { .. } => return None,
        };
        let choices = parameter.choices.iter().map(|choice| format!("{} {}", choice.value, choice.name));
        let text = choices.collect::<Vec<_>>().join(", ");
        let name = format!("controller.parameters.{}", parameter.name);
        Some(Variable::new(Role::Parameter, name, &parameter.unit, start, &text))
    };
    session.parameters.iter().filter(is_of_law).filter_map(variable).collect()
}
