//! Bench and drive of different minor versions: each ignores what it doesn't know, and the run is the same. A message that is
//! due and missing is remarked.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Instant;

use lashloop_bench::device::Device;
use lashloop_bench::device::kinds::in_process::InProcessDrive;
use lashloop_bench::run::{self, Clock, DeviceUnderTest, End, Observers};
use lashloop_bench::scenario::{Override, Scenario};
use lashloop_bench::supervisor::Supervisor;
use lashloop_link::{Link, LinkError};
use lashloop_protocol::enums::{FaultCode, Outcome};
use lashloop_protocol::frame::{self, DELIMITER};
use lashloop_protocol::layout::MessageLayout;
use lashloop_protocol::limits::FAULT_NAMES;
use lashloop_protocol::message::{
    Arm, ChoiceDescription, CommandResult, DescribeChoice, EncoderSample, FaultReport, Hello, Identity,
    Telemetry, TorqueAnswer,
};
use lashloop_protocol::text::Text;
use lashloop_protocol::wire::Payload;
use lashloop_protocol::{DriveMessage, Frame, Message};

/// Faults that version 1.1 adds, with their names.
const NEW_FAULTS: [(u8, &str); 3] = [(77, "BrakeOpen"), (78, "OverTemperature"), (79, "SupplyLow")];
/// Kinds that version 1.1 adds: a report of a drive in every period, an answer of a drive, a request and a sample of a host.
const NEW_REPORT: u8 = 0x9c;
const NEW_ANSWER: u8 = 0xc1;
const NEW_REQUEST: u8 = 0x21;
const NEW_SAMPLE: u8 = 0x1b;
/// Number of the further request; the bench of this test gets nowhere near it.
const NEW_NUMBER: u8 = 254;

/// The body of a frame; `None` for a lone delimiter.
fn body_of(frame: &[u8]) -> Option<Vec<u8>> {
    let mut stuffed = frame.strip_suffix(&[DELIMITER]).filter(|stuffed| !stuffed.is_empty())?.to_vec();
    Some(frame::open(&mut stuffed).expect("a good frame").to_vec())
}

/// Changes each message between bench and drive.
trait Newer: Send {
    /// What the drive receives.
    fn request(&mut self, body: Vec<u8>, answers: &mut Vec<u8>) -> Vec<Vec<u8>>;
    /// What the bench receives.
    fn answer(&mut self, body: Vec<u8>) -> Vec<Vec<u8>>;
}

/// A drive of version 1.1: two more fields, more messages, more flags, and a fault of this code for a jump of the motor.
struct NewerDrive {
    fault: u8,
    has_names: bool,
}

impl Newer for NewerDrive {
    fn request(&mut self, body: Vec<u8>, answers: &mut Vec<u8>) -> Vec<Vec<u8>> {
        let choice = NEW_FAULTS.iter().find(|(code, _)| body.get(3) == Some(code));
        if let (&[kind, number, FAULT_NAMES, choice], Some((_, name)), true) =
            (&body[..], choice, self.has_names)
            && kind == DescribeChoice::LAYOUT.kind
        {
            let description = ChoiceDescription { parameter: FAULT_NAMES, choice, name: Text::new(name) };
            answers.extend_from_slice(&DriveMessage::from(description).numbered_frame(number));
            return Vec::new();
        }
        vec![body]
    }

    fn answer(&mut self, mut body: Vec<u8>) -> Vec<Vec<u8>> {
        let at = |layout: MessageLayout, name: &str| {
            layout.fields.iter().find(|field| field.name == name).expect("a field").offset
        };
        match body[0] {
            kind if kind == Identity::LAYOUT.kind => {
                body[at(Identity::LAYOUT, "minor_version")] = 1;
                body[at(Identity::LAYOUT, "capabilities")] |= 0x80;
                body.extend([1, 2]);
                vec![body]
            }
            kind if kind == CommandResult::LAYOUT.kind => {
                body.extend([3, 4, 5]);
                vec![vec![NEW_ANSWER, 9, 1], body]
            }
            kind if kind == TorqueAnswer::LAYOUT.kind => {
                body[at(TorqueAnswer::LAYOUT, "status")] |= 0x80;
                vec![vec![NEW_REPORT, 1, 2, 3], body]
            }
            kind if kind == FaultReport::LAYOUT.kind => {
                let code = &mut body[at(FaultReport::LAYOUT, "code")];
                if *code == FaultCode::MotorEncoderJump.byte() {
                    *code = self.fault;
                }
                vec![body]
            }
            _ => vec![body],
        }
    }
}

/// A host of version 1.1: longer requests, a further request before each `Arm` and a further message with each sample.
#[derive(Default)]
struct NewerHost {
    /// Answers to the further request.
    answered: Arc<AtomicU32>,
}

impl Newer for NewerHost {
    fn request(&mut self, mut body: Vec<u8>, _: &mut Vec<u8>) -> Vec<Vec<u8>> {
        let kind = body[0];
        if kind == Hello::LAYOUT.kind {
            body[3] = 1;
        }
        body.extend([1, 2]);
        if kind == Arm::LAYOUT.kind {
            return vec![vec![NEW_REQUEST, NEW_NUMBER, 7], body];
        }
        if kind == EncoderSample::LAYOUT.kind { vec![vec![NEW_SAMPLE, 7], body] } else { vec![body] }
    }

    fn answer(&mut self, body: Vec<u8>) -> Vec<Vec<u8>> {
        if let [kind, number, request, outcome, ..] = body[..]
            && kind == CommandResult::LAYOUT.kind
        {
            assert_ne!(request, NEW_SAMPLE, "no answer to what is sent in every period");
            let is_new = (number, request) == (NEW_NUMBER, NEW_REQUEST);
            assert_eq!(is_new, outcome == Outcome::UnknownRequest.byte());
            self.answered.fetch_add(u32::from(is_new), Ordering::Relaxed);
        }
        vec![body]
    }
}

/// A drive that omits its telemetry.
struct WithoutTelemetry;

impl Newer for WithoutTelemetry {
    fn request(&mut self, body: Vec<u8>, _: &mut Vec<u8>) -> Vec<Vec<u8>> {
        vec![body]
    }

    fn answer(&mut self, body: Vec<u8>) -> Vec<Vec<u8>> {
        if body[0] == Telemetry::LAYOUT.kind { Vec::new() } else { vec![body] }
    }
}

struct Between<N> {
    link: Box<dyn Link>,
    newer: N,
    /// Arrived and not read yet.
    ready: Vec<u8>,
}

impl<N: Newer> Link for Between<N> {
    fn inner(&mut self) -> Option<&mut dyn Link> {
        Some(self.link.as_mut())
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        for frame in bytes.split_inclusive(|byte| *byte == DELIMITER) {
            match body_of(frame) {
                Some(body) => {
                    for body in self.newer.request(body, &mut self.ready) {
                        self.link.send(&Frame::around(&body))?;
                    }
                }
                None => self.link.send(frame)?,
            }
        }
        Ok(())
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
        if self.ready.is_empty() {
            let mut arrived = [0; 1024];
            let count = self.link.receive(&mut arrived, deadline)?;
            for frame in arrived[..count].split_inclusive(|byte| *byte == DELIMITER) {
                let bodies = body_of(frame).map(|body| self.newer.answer(body)).unwrap_or_default();
                self.ready.extend(bodies.iter().flat_map(|body| Frame::around(body).to_vec()));
                // No byte would be a timeout.
                self.ready.push(DELIMITER);
            }
        }
        let count = self.ready.len().min(buffer.len());
        buffer[..count].copy_from_slice(&self.ready[..count]);
        self.ready.drain(..count);
        Ok(count)
    }

    fn discard_input(&mut self) -> Result<(), LinkError> {
        self.ready.clear();
        self.link.discard_input()
    }
}

fn run_on(settings: &[&str], around: impl FnOnce(Box<dyn Link>) -> Box<dyn Link>) -> run::Outcome {
    let path = tests::workspace().join("scenarios/smooth-after.toml");
    let text = std::fs::read_to_string(path).expect("a scenario");
    let settings: Vec<_> = ["run.duration_s=0.3", "expect=[]"]
        .iter()
        .chain(settings)
        .map(|setting| Override::Set((*setting).to_owned()))
        .collect();
    let scenario = Scenario::from_str("scenarios/newer.toml", &text, &settings).expect("a scenario");
    let supervisor = Supervisor::start(PathBuf::from("never started")).expect("a supervisor");
    let device = Device::open_through(&<InProcessDrive>::default().into(), 0, &supervisor, around);
    let mut device = DeviceUnderTest { device: device.expect("a drive in process"), link_faults: None };
    let mut nobody = Observers(Vec::new());
    run::run(&scenario, &mut device, Clock::Lockstep, &mut nobody).expect("a run to its end")
}

fn run_of(settings: &[&str], newer: impl Newer + 'static) -> run::Outcome {
    run_on(settings, |link| Box::new(Between { link, newer, ready: Vec::new() }))
}

#[test]
fn a_run_on_a_drive_of_a_newer_minor_version_is_the_same() {
    let plain = run_on(&[], |link| link);
    let newer = run_of(&[], NewerDrive { fault: 0, has_names: true });
    assert_eq!((&newer.end, &newer.torque_sha256), (&End::Complete, &plain.torque_sha256));
    assert_eq!(newer.logs, plain.logs, "nothing to remark");
}

#[test]
fn a_run_of_a_newer_bench_on_this_drive_is_the_same() {
    let plain = run_on(&[], |link| link);
    let host = NewerHost::default();
    let answered = Arc::clone(&host.answered);
    let newer = run_of(&[], host);
    assert_eq!((&newer.end, &newer.torque_sha256), (&End::Complete, &plain.torque_sha256));
    assert_eq!(answered.load(Ordering::Relaxed), 1);
}

#[test]
fn a_new_fault_has_the_name_that_the_drive_gives_it() {
    for (fault, name) in NEW_FAULTS {
        for (has_names, shown) in [(true, format!("{name} ({fault})")), (false, format!("unknown {fault}"))] {
            let jump = ["controller.parameters.motor_speed_limit_rad_s=2"];
            let end = run_of(&jump, NewerDrive { fault, has_names }).end;
            let text = end.to_string();
            assert!(text.starts_with(&format!("the drive latched {shown} at sample ")), "{text}");
            assert!(matches!(end, End::DriveFault(it) if it.code.byte() == fault), "{text}");
        }
    }
}

#[test]
fn missing_telemetry_is_in_the_log_of_a_run() {
    let every = ["telemetry.every_steps=10"];
    assert!(!run_on(&every, |link| link).logs.iter().any(|log| log.contains("telemetry is missing")));
    let logs = run_of(&every, WithoutTelemetry).logs;
    let missing = "telemetry is missing: 30 due, every 10 samples, 0 received";
    assert!(logs.iter().any(|log| log == missing), "{logs:?}");
}
