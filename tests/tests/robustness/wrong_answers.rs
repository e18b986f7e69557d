//! Drives whose torque answers break a rule: the run ends at once, without their torque, and fails.

use std::path::PathBuf;
use std::time::Instant;

use lashloop_bench::atomic_file::WriteError;
use lashloop_bench::device::Device;
use lashloop_bench::device::kinds::in_process::InProcessDrive;
use lashloop_bench::fault::link::LinkFaults;
use lashloop_bench::run::{self, Clock, DeviceUnderTest, End, Outcome, Step, StepObserver};
use lashloop_bench::scenario::{Override, Scenario};
use lashloop_bench::supervisor::Supervisor;
use lashloop_bench::verdict::Verdict;
use lashloop_link::{Link, LinkError};
use lashloop_protocol::enums::{State, TorqueFlags};
use lashloop_protocol::message::TorqueAnswer;
use lashloop_protocol::{Decoder, DriveMessage, Message, Numbered};

const LIMIT_NM: f32 = 8.0;
/// The sample whose answer is wrong.
const AT: u16 = 200;

/// A link that alters the drive's torque answers and drops reports of faults, if it is to.
struct Altered<F> {
    link: Box<dyn Link>,
    decoder: Decoder,
    alter: F,
    drops_reports: bool,
}

impl<F: FnMut(&mut TorqueAnswer) + Send> Link for Altered<F> {
    fn inner(&mut self) -> Option<&mut dyn Link> {
        Some(self.link.as_mut())
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.link.send(bytes)
    }

    fn discard_input(&mut self) -> Result<(), LinkError> {
        self.link.discard_input()
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
        let mut arrived = [0; 1024];
        let count = self.link.receive(&mut arrived, deadline)?;
        let mut bytes = &arrived[..count];
        let mut altered = Vec::new();
        while let Some(message) = self.decoder.next::<DriveMessage>(&mut bytes) {
            let Numbered { number, mut message } = message.expect("the drive sends good frames");
            match &mut message {
                DriveMessage::TorqueAnswer(answer) => (self.alter)(answer),
                DriveMessage::FaultReport(_) if self.drops_reports => {
                    self.drops_reports = false;
                    // A lone delimiter isn't a frame.
                    altered.push(0);
                    continue;
                }
                _ => {}
            }
            altered.extend_from_slice(&message.numbered_frame(number));
        }
        buffer[..altered.len()].copy_from_slice(&altered);
        Ok(altered.len())
    }
}

/// The torques of the record.
#[derive(Default)]
struct Torques(Vec<f32>);

impl StepObserver for Torques {
    fn step(&mut self, step: &Step) -> Result<(), WriteError> {
        self.0.push(step.row.torque_nm as f32);
        Ok(())
    }
}

fn run_with(
    fault: &str,
    drops_reports: bool,
    alter: impl FnMut(&mut TorqueAnswer) + Send + 'static,
) -> (Outcome, Vec<f32>) {
    let text =
        std::fs::read_to_string(tests::workspace().join("scenarios/smooth-before.toml")).expect("a scenario");
    // Each lost frame costs its timeout in virtual time; consecutive ones must not add up to a lost drive.
    let settings = [
        "run.duration_s=0.5".to_owned(),
        "link.silence_limit_ms=60000".to_owned(),
        format!("controller.parameters.torque_limit_nm={LIMIT_NM}"),
    ];
    let scenario = Scenario::from_str(
        "scenarios/wrong.toml",
        &format!("{text}\n{fault}\n"),
        &settings.map(Override::Set),
    );
    let scenario = scenario.expect("a good scenario");
    let supervisor = Supervisor::start(PathBuf::from("never started")).expect("a supervisor");
    let link_faults = LinkFaults::new(&scenario);
    let around = |link| {
        let altered = Altered { link, decoder: Decoder::new(), alter, drops_reports };
        match &link_faults {
            Some(faults) => faults.wrap(Box::new(altered), &scenario),
            None => Box::new(altered) as Box<dyn Link>,
        }
    };
    let device = Device::open_through(&<InProcessDrive>::default().into(), 0, &supervisor, around);
    let mut device = DeviceUnderTest { device: device.expect("a drive in process"), link_faults };
    let mut torques = Torques::default();
    let outcome = run::run(&scenario, &mut device, Clock::Lockstep, &mut torques).expect("a run to its end");
    (outcome, torques.0)
}

fn at(number: u16, alter: impl Fn(&mut TorqueAnswer) + Send) -> impl FnMut(&mut TorqueAnswer) + Send {
    move |answer| {
        if answer.sequence == number {
            alter(answer);
        }
    }
}

/// Requires a run that ends in the step of the wrong answer, by this rule, with a torque of zero.
fn assert_fails(rule: &str, value: &str, limit: &str, alter: impl Fn(&mut TorqueAnswer) + Send + 'static) {
    let (outcome, torques) = run_with("", false, at(AT, alter));
    let broken = outcome.end.broken_rule().unwrap_or_else(|| panic!("rule {rule}: {}", outcome.end));
    assert_eq!((broken.rule.number(), broken.step, broken.sequence), (rule, u32::from(AT), AT));
    assert_eq!((broken.rule.value(), broken.rule.limit()), (value.to_owned(), limit.to_owned()));
    assert_eq!(outcome.judgement.verdict, Verdict::Fail);
    assert_eq!(torques.len(), usize::from(AT) + 1, "the run ends in the step of the answer");
    assert_ne!(torques[usize::from(AT) - 1], 0.0);
    assert_eq!(torques[usize::from(AT)], 0.0, "the motor gets no torque of this drive");
}

fn assert_passes(fault: &str, alter: impl FnMut(&mut TorqueAnswer) + Send + 'static) -> Outcome {
    let (outcome, _) = run_with(fault, false, alter);
    assert_eq!(outcome.end, End::Complete);
    assert!(outcome.faults.iter().all(|fault| fault.frames > Some(0)), "a fault that hits nothing");
    outcome
}

#[test]
fn a_torque_one_ulp_beyond_the_limit_ends_the_run() {
    assert_fails("R7.11", "torque 8.000001 N m", "8 N m", |it| it.torque_nm = LIMIT_NM.next_up());
    assert_fails("R7.11", "torque -8.000001 N m", "8 N m", |it| it.torque_nm = -LIMIT_NM.next_up());
    let _ = assert_passes("", at(AT, |it| it.torque_nm = -LIMIT_NM));
}

#[test]
fn a_torque_that_is_not_finite_ends_the_run() {
    assert_fails("R7.12", "torque NaN N m", "finite", |it| it.torque_nm = f32::NAN);
    assert_fails("R7.12", "torque -inf N m", "finite", |it| it.torque_nm = f32::NEG_INFINITY);
}

#[test]
fn saturated_below_the_limit_ends_the_run() {
    assert_fails("R7.11", "torque 7.5 N m", "8 N m", |it| {
        it.torque_nm = 7.5;
        it.status.flags = TorqueFlags::SATURATED;
    });
}

#[test]
fn a_torque_of_a_drive_that_does_not_run_ends_the_run() {
    assert_fails("R6.1", "torque 0.001 N m in state Faulted", "0 N m", |it| {
        (it.torque_nm, it.status.state, it.status.flags) = (0.001, State::Faulted, TorqueFlags::empty());
    });
}

#[test]
fn a_flag_gap_without_a_gap_ends_the_run() {
    assert_fails("R7.4", "flag GAP", "the sample before was answered", |it| {
        it.status.flags |= TorqueFlags::GAP;
    });
}

#[test]
fn a_flag_repeated_on_a_sample_sent_once_ends_the_run() {
    assert_fails("R7.3", "flag REPEATED", "the sample was sent once", |it| {
        it.status.flags |= TorqueFlags::REPEATED;
    });
}

#[test]
fn a_state_without_a_fault_ends_the_run() {
    for state in [State::Boot, State::Idle, State::Armed, State::Faulted] {
        let value = format!("state {state:?} without a fault report");
        assert_fails("R6.2", &value, "state Running", move |it| {
            (it.torque_nm, it.status.state, it.status.flags) = (-0.0, state, TorqueFlags::empty());
        });
    }
}

#[test]
fn a_missing_flag_gap_ends_the_run() {
    // The first answers are lost, so the bench retransmits sample 0 and leaves out the samples of these steps.
    let lost =
        "[[fault]]\nkind = \"link-byte-loss\"\nshare = 1.0\nway = \"to-bench\"\nat_s = 0.0\nfor_s = 0.01";
    let (outcome, _) = run_with(lost, false, |it| it.status.flags -= TorqueFlags::GAP);
    let broken = outcome.end.broken_rule().expect("a flag that misses");
    assert_eq!((broken.rule.number(), broken.rule.value()), ("R7.2", "no flag GAP".to_owned()));
    assert_eq!(outcome.judgement.verdict, Verdict::Fail, "a lossy line doesn't excuse it");
    let _ = assert_passes(lost, |_| {});
}

#[test]
fn no_impairment_of_the_line_breaks_a_rule() {
    for kind in [
        "link-byte-loss\"\nshare = 0.2",
        "link-bit-flip\"\nshare = 0.2",
        "link-duplicate\"\nshare = 0.4",
        "link-reorder\"\nshare = 0.4",
        "link-delay\"\ndelay_ms = 30.0\njitter_ms = 900.0",
    ] {
        for way in ["to-drive", "to-bench", "both"] {
            let fault = format!("[[fault]]\nkind = \"{kind}\nway = \"{way}\"\nat_s = 0.0");
            let _ = assert_passes(&fault, |_| {});
        }
    }
    let all = ["link-byte-loss", "link-duplicate", "link-reorder"]
        .map(|kind| format!("[[fault]]\nkind = \"{kind}\"\nshare = 0.15\nat_s = 0.0"));
    let _ = assert_passes(&all.join("\n"), |_| {});
}

#[test]
fn a_lost_fault_report_is_a_fault_and_no_broken_rule() {
    // The encoder jumps; the report of that fault is lost, and the drive sends it again after the identity.
    let jump = "[[fault]]\nkind = \"encoder-jump\"\nside = \"load\"\ncounts = 2000000\nat_s = 0.2";
    let (outcome, _) = run_with(jump, true, |_| {});
    assert!(matches!(&outcome.end, End::DriveFault(fault) if fault.step == 200), "{}", outcome.end);
    assert_eq!(outcome.judgement.verdict, Verdict::Fail);
}
