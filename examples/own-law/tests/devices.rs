//! The law on the bench: in process, and on the native twin of this crate.

use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};

use lashloop_bench::device::kinds::in_process::InProcessDrive;
use lashloop_bench::device::{Device, DeviceChoice};
use lashloop_bench::run::{self, Clock, DeviceUnderTest, Outcome, StepObserver};
use lashloop_bench::scenario::Scenario;
use lashloop_bench::supervisor::Supervisor;
use lashloop_bench::verdict::Verdict;
use own_law::OwnLaws;

const SCENARIO: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/own-law.toml");

struct Unobserved;

impl StepObserver for Unobserved {}

/// The native twin. Dropping it kills it.
struct Twin(Child);

impl Twin {
    fn start() -> (Self, String) {
        let program = Command::new(env!("CARGO_BIN_EXE_own-law")).stdout(Stdio::piped()).spawn();
        let mut child = program.expect("the twin starts");
        let mut path = String::new();
        let stdout = child.stdout.take().expect("a pipe");
        BufReader::new(stdout).read_line(&mut path).expect("the path of a terminal");
        (Self(child), path.trim().to_owned())
    }
}

impl Drop for Twin {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn supervisor() -> Supervisor {
    Supervisor::start(PathBuf::from("never started")).expect("a supervisor")
}

fn run_on(choice: &DeviceChoice) -> Outcome {
    let text = std::fs::read_to_string(SCENARIO).expect("the scenario of this crate");
    let scenario = Scenario::from_str(SCENARIO, &text, &[]).expect("a good scenario");
    let mut device = DeviceUnderTest::open(&scenario, choice, &supervisor(), |link| link).expect("a drive");
    run::run(&scenario, &mut device, Clock::Lockstep, &mut Unobserved).expect("a run to its end")
}

fn in_process() -> DeviceChoice {
    InProcessDrive::<OwnLaws>::default().into()
}

#[test]
fn the_host_sees_the_law_its_parameters_and_its_signal() {
    let device = Device::open(&in_process(), 0, &supervisor()).expect("a drive");
    let parameter = device.session.parameter("velocity_gain_nm_s_rad").expect("a parameter of the law");
    assert_eq!(parameter.unit, "N m s/rad");
    let signal = device.session.signal("wanted_twist_rad").expect("a signal of the law");
    assert_eq!(signal.signal.unit, "rad");
}

#[test]
fn the_scenario_passes_with_equal_torques_in_process_and_on_the_twin() {
    let here = run_on(&in_process());
    assert_eq!(here.judgement.verdict, Verdict::Pass, "{:?}", here.judgement);
    let (_twin, path) = Twin::start();
    let there = run_on(&path.parse().expect("the path of a terminal"));
    assert_eq!(here.torque_sha256, there.torque_sha256);
    let names: Vec<&str> = there.signals.drive.iter().map(|signal| &*signal.name).collect();
    assert_eq!(names, ["measured_twist_rad", "wanted_twist_rad"]);
}
