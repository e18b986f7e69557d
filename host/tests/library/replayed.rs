//! The samples of a run, sent to other firmware without a plant.

use lashloop::replay::{RecordedStep, Recording, Replay, ReplayError, replay};
use lashloop::{Bench, Device, Scenario};
use lashloop_bench::atomic_file::WriteError;
use lashloop_bench::device::Device as OpenDevice;
use lashloop_bench::run::{self, Clock, DeviceUnderTest, RunStart, Step, StepObserver};
use lashloop_bench::supervisor::Supervisor;
use lashloop_bench::timing::{ClockName, StepOutcome};
use lashloop_record::diff::Agreement;
use lashloop_record::manifest::{Number, ParameterInForce};
use own_law::OwnLaws;

/// What a record keeps of a run for its replay.
#[derive(Default)]
struct Recorder {
    recording: Recording,
    parameters: Vec<ParameterInForce>,
}

impl StepObserver for Recorder {
    fn begin(&mut self, start: &RunStart<'_>) -> Result<(), WriteError> {
        let session = &start.device.session;
        let law =
            session.laws.iter().find(|law| law.name == start.scenario.controller.name).expect("the law");
        let of_law = session.parameters.iter().filter(|it| it.laws.contains(law.index));
        self.parameters = of_law.map(|it| ParameterInForce::new(it, session.in_force(it), true)).collect();
        Ok(())
    }

    fn step(&mut self, step: &Step) -> Result<(), WriteError> {
        let number = (step.row.time_s / self.recording.period_s).round() as u32;
        let answered = step.timing.outcome == StepOutcome::Answered;
        if let Some(sample) = step.sample {
            let torque_nm = answered.then_some(step.row.torque_nm as f32);
            self.recording.steps.push(RecordedStep { step: number, sample, torque_nm });
        }
        Ok(())
    }
}

fn scenario(settings: &[&str]) -> Scenario {
    let short = ["run.duration_s=0.3", "expect=[]"];
    Bench::new()
        .scenario("../scenarios/smooth-after.toml", &[&short[..], settings].concat())
        .expect("a scenario")
}

/// Samples, torques and parameters of a run in process.
fn recorded(scenario: &Scenario) -> (Recording, Vec<ParameterInForce>) {
    let supervisor = Supervisor::without_signals(None).expect("a thread");
    let choice = Bench::new().device("inproc").expect("a device");
    let opened = DeviceUnderTest::open(scenario, &choice, ClockName::Lockstep, &supervisor, |link| link);
    let mut recorder = Recorder::default();
    recorder.recording.period_s = 1e-3;
    run::run(scenario, &mut opened.expect("a drive"), Clock::Lockstep, &mut recorder).expect("a run");
    (recorder.recording, recorder.parameters)
}

fn replayed(
    scenario: &Scenario,
    (recording, parameters): &(Recording, Vec<ParameterInForce>),
    device: &Device,
) -> Result<Replay, ReplayError> {
    let supervisor = Supervisor::without_signals(None).expect("a thread");
    let mut device = OpenDevice::open(device, scenario.link.baud, &supervisor).expect("a drive");
    replay(recording, parameters, &scenario.link, None, &mut device, || false)
}

/// A parameter of the law in force.
fn parameter(name: &str, value: Number, choice: Option<&str>) -> ParameterInForce {
    let (unit, choice) = (String::new(), choice.map(str::to_owned));
    ParameterInForce { name: name.to_owned(), value, choice, unit, default: value, of_law: true }
}

fn own_laws() -> Device {
    Bench::new().with_laws::<OwnLaws>().device("inproc").expect("a device")
}

#[test]
fn firmware_that_numbers_its_laws_differently_gives_the_same_torques() {
    let scenario = scenario(&[]);
    let result = replayed(&scenario, &recorded(&scenario), &own_laws()).expect("a replay");
    assert_eq!(
        (result.compared, result.differing, result.agreement()),
        (300, 0, Agreement::Bits),
        "{result}"
    );
}

#[test]
fn one_bit_of_a_torque_is_named_with_its_step_and_both_values() {
    let scenario = scenario(&[]);
    let mut run = recorded(&scenario);
    let torque_nm = run.0.steps[137].torque_nm.as_mut().expect("an answer");
    let replayed_nm = *torque_nm;
    *torque_nm = f32::from_bits(torque_nm.to_bits() ^ 1);
    let recorded_nm = *torque_nm;
    let result = replayed(&scenario, &run, &own_laws()).expect("a replay");
    let first = result.first.expect("a difference");
    assert_eq!((first.step, first.recorded_nm, first.replayed_nm), (137, recorded_nm, replayed_nm));
    assert_eq!(
        (result.differing, result.largest, result.agreement()),
        (1, Some(first), Agreement::Different)
    );
    let text = result.to_string();
    assert!(
        text.contains("first       step 137, 0.137 s: recorded ") && text.ends_with("DIFFERENT"),
        "{text}"
    );
}

#[test]
fn changed_gain_differs_from_its_first_step_on() {
    let [before, after] =
        ["10.0", "10.5"].map(|gain| scenario(&[&format!("controller.parameters.k_p2={gain}")]));
    let run = (recorded(&before).0, recorded(&after).1);
    let result = replayed(&before, &run, &own_laws()).expect("a replay");
    assert_eq!(result.first.map(|first| first.step), Some(0), "the load starts away from its reference");
    assert!(result.differing > 250, "{result}");
}

#[test]
fn missed_steps_stay_missed_and_unanswered_samples_are_sent() {
    // The drive bridges a gap of samples by its own rule, so a replay with all samples differs from there on.
    let scenario = scenario(&[]);
    let mut run = recorded(&scenario);
    run.0.steps.drain(100..103);
    run.0.missed = 3;
    let with_a_gap = replayed(&scenario, &run, &own_laws()).expect("a replay");
    assert_eq!(with_a_gap.first.map(|first| first.step), Some(103), "{with_a_gap}");
    run.0.steps[40].torque_nm = None;
    let unanswered = replayed(&scenario, &run, &own_laws()).expect("a replay");
    assert_eq!((unanswered.unanswered, unanswered.first_unanswered), (1, Some(40)));
    assert_eq!((unanswered.compared, unanswered.first), (296, with_a_gap.first));
}

#[test]
fn parameter_that_the_firmware_lacks_is_named_before_any_sample() {
    let scenario = scenario(&[]);
    let (recording, _) = recorded(&scenario);
    for (parameter, part) in [
        (
            parameter("brake_gain", Number::Real(1.5), None),
            "inproc has no parameter brake_gain, which was 1.5",
        ),
        (
            parameter("controller", Number::Whole(4), Some("braking-curve")),
            "does not take controller = braking-curve",
        ),
        (parameter("torque_limit_nm", Number::Real(-1.0), None), "does not take torque_limit_nm = -1.0"),
    ] {
        let error = replayed(&scenario, &(recording.clone(), vec![parameter]), &own_laws()).expect_err(part);
        assert!(error.to_string().contains(part), "{error}");
    }
}

#[test]
fn fault_that_only_the_replay_latches_is_a_difference() {
    let scenario = scenario(&[]);
    let (recording, _) = recorded(&scenario);
    // The load moves at 3 rad/s and more.
    let strict = [
        parameter("controller", Number::Whole(1), Some("merzouki")),
        parameter("motor_speed_limit_rad_s", Number::Real(1.0), None),
    ];
    let run = (recording, strict.to_vec());
    let result = replayed(&scenario, &run, &own_laws()).expect("a replay");
    assert!(
        result.agreement() == Agreement::Different
            && result.end.is_some()
            && result.to_string().contains("latched"),
        "{result}"
    );
}
