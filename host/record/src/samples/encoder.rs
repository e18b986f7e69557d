//! The topics of a run, and what happens in it as their messages: for `run.mcap`, and for those who watch.

use lashloop_bench::run::{Event, Step};
use lashloop_plant::metrics::SignalTable;

use super::columns::{
    DRIVE_TOPIC, FAULT_TOPIC, LOG_TOPIC, STEP_TOPIC, drive_fields, step_fields, step_values,
};
use super::events::{self, FAULT_SCHEMA, LOG_SCHEMA};
use super::layout::{Field, encode, schema};
use super::step_times::StepTimes;

/// Messages of one schema.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Topic {
    /// Its name, such as `/step`.
    pub name: &'static str,
    /// Name of the schema, as of a package of ROS 2.
    pub schema_name: String,
    /// The schema as `ros2msg`. The comment of a field has the name and the unit of its column.
    pub schema: String,
}

/// Where and when a message belongs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Place {
    /// Number of the topic in [`Encoder::topics`].
    pub topic: usize,
    /// Number of the message, by the rule of its topic.
    pub sequence: u32,
    /// Time of its values, in ns since 1970.
    pub log_time_ns: u64,
    /// Time of the step in which it came, in ns since 1970.
    pub publish_time_ns: u64,
}

/// Encodes the steps and events of a run, one by one, in CDR.
#[derive(Debug)]
pub struct Encoder {
    times: StepTimes,
    step: Vec<Field>,
    /// Without a field the topic is left out: a message of ROS 2 has at least one.
    drive: Vec<Field>,
    steps: u64,
    events: u64,
    /// Time of the sample of the last telemetry, for what repeats it.
    telemetry_time_s: Option<f64>,
    message: Vec<u8>,
}

impl Encoder {
    /// `first_step` is the number of the first step to come.
    #[must_use]
    pub fn new(signals: &SignalTable, times: StepTimes, first_step: u64) -> Self {
        let (step, drive) = (step_fields(signals), drive_fields(signals));
        Self { times, step, drive, steps: first_step, events: 0, telemetry_time_s: None, message: Vec::new() }
    }

    /// The topics, in the order of their numbers.
    #[must_use]
    pub fn topics(&self) -> Vec<Topic> {
        let topic = |name, schema_name: &str, schema| Topic {
            name,
            schema_name: full_schema_name(schema_name),
            schema,
        };
        let drive = self.has_drive().then(|| topic(DRIVE_TOPIC, "Drive", schema(&self.drive)));
        let of_events = [
            topic(FAULT_TOPIC, "Fault", FAULT_SCHEMA.to_owned()),
            topic(LOG_TOPIC, "Log", LOG_SCHEMA.to_owned()),
        ];
        [topic(STEP_TOPIC, "Step", schema(&self.step))].into_iter().chain(drive).chain(of_events).collect()
    }

    fn has_drive(&self) -> bool {
        !self.drive.is_empty()
    }

    /// Start and period of the run.
    #[must_use]
    pub fn times(&self) -> StepTimes {
        self.times
    }

    /// Number of the next step.
    #[must_use]
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// The messages of a step.
    pub fn step(&mut self, step: &Step, mut take: impl FnMut(Place, &[u8])) {
        let (number, now_ns) = (self.steps, self.times.at(self.steps));
        self.steps += 1;
        encode(&self.step, step_values(number, step), &mut self.message);
        let place = Place { topic: 0, sequence: 0, log_time_ns: now_ns, publish_time_ns: now_ns };
        take(place, &self.message);
        if self.has_drive() && step.drive.time_s != self.telemetry_time_s {
            self.telemetry_time_s = step.drive.time_s;
            let time_ns = step.drive.time_s.map_or(0, |time_s| (time_s * 1e9).round() as u64);
            encode(&self.drive, step.drive.values.iter().copied(), &mut self.message);
            let log_time_ns = self.times.start_ns + time_ns;
            take(Place { topic: 1, sequence: number as u32, log_time_ns, ..place }, &self.message);
        }
    }

    /// The message of an event of a step.
    pub fn event(&mut self, step: u32, event: &Event, mut take: impl FnMut(Place, &[u8])) {
        events::encode(event, &mut self.message);
        let faults = 1 + usize::from(self.has_drive());
        let (topic, step) = match event {
            Event::Fault(edge) => (faults, edge.step),
            Event::Log(_) => (faults + 1, step),
        };
        let (log_time_ns, publish_time_ns) = (self.times.at(step.into()), self.times.at(self.steps));
        take(Place { topic, sequence: self.events as u32, log_time_ns, publish_time_ns }, &self.message);
        self.events += 1;
    }
}

/// The name of a schema within our package.
pub(super) fn full_schema_name(name: &str) -> String {
    format!("lashloop_msgs/msg/{name}")
}
