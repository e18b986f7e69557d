//! A line that loses requests or answers. The bench retries an unanswered request, and the run is the same.

use std::collections::BTreeSet;
use std::sync::mpsc;

use lashloop_protocol::enums::FaultCode;
use lashloop_protocol::message::{Arm, Reset, Start, Stop, Subscribe};
use lashloop_protocol::wire::Payload;
use lashloop_protocol::{DriveMessage, HostMessage, Message};
use tests::paper::RUNS;
use tests::program;
use tests::records::Records;
use tests::relay::{Action, Relay, Transit};
use tests::twin::Twin;

/// Drops a frame.
fn drop_frame() -> Action {
    Action::Replace(Vec::new())
}

/// Kind of a request of the bench; `None` for a sample.
fn request(frame: &Transit) -> Option<&'static str> {
    let message = frame.from_bench().filter(|message| !matches!(message, HostMessage::EncoderSample(_)));
    Some(message?.layout().name)
}

/// Kind of an answer to a request.
fn answer(frame: &Transit) -> Option<String> {
    match frame.from_drive()? {
        DriveMessage::CommandResult(result) => Some(format!("answer to {:#04x}", result.request)),
        DriveMessage::TorqueAnswer(_) | DriveMessage::Telemetry(_) => None,
        message => Some(message.layout().name.to_owned()),
    }
}

/// Digest of the torques of a run.
fn torques_of_a_run(device: &str, settings: &[&str]) -> String {
    let records = Records::new();
    let (scenario, out) = (RUNS[1].scenario(), records.out());
    let mut arguments = vec!["run", &scenario, "--device", device, "--out", &out];
    // The run is too short for the expectation of the scenario.
    for setting in ["run.duration_s=0.05", "expect.0.max=1000", "expect.0.min=0"].iter().chain(settings) {
        arguments.extend(["--set", setting]);
    }
    let ended = program::run(arguments);
    assert!([Some(0), Some(1)].contains(&ended.code), "{}{}", ended.stdout, ended.stderr);
    let summary = records.summary();
    assert_eq!(summary["end"], "complete", "{summary}");
    summary["torque_sha256"].as_str().expect("a digest").to_owned()
}

/// Digest of the torques of a run over a faulty line.
fn torques_over(tamper: impl FnMut(&Transit) -> Action + Send + 'static, settings: &[&str]) -> String {
    let twin = Twin::start();
    let relay = Relay::start(twin.path(), tamper);
    torques_of_a_run(relay.device(), settings)
}

/// Drops the first frame of each kind.
fn drop_the_first<Kind: Ord + Clone>(
    kind: impl Fn(&Transit) -> Option<Kind> + Send + 'static,
    dropped: mpsc::Sender<Kind>,
) -> impl FnMut(&Transit) -> Action {
    let mut seen = BTreeSet::new();
    move |frame| {
        let Some(kind) = kind(frame).filter(|kind| seen.insert(kind.clone())) else { return Action::Forward };
        let _ = dropped.send(kind);
        drop_frame()
    }
}

#[test]
fn a_run_survives_the_loss_of_each_first_request() {
    let (sender, dropped) = mpsc::channel();
    let torques = torques_over(drop_the_first(request, sender), &[]);
    let setup = ["Hello", "DescribeLaw", "DescribeParameter", "DescribeChoice", "DescribeSignal"];
    let run = ["Reset", "SetParameter", "Subscribe", "GetParameter", "Arm", "Start", "Stop"];
    assert_eq!(dropped.iter().collect::<Vec<_>>(), [&setup[..], &run].concat());
    assert_eq!(torques, torques_of_a_run("native", &[]));
}

#[test]
fn a_run_survives_the_loss_of_each_first_answer() {
    let (sender, dropped) = mpsc::channel();
    let torques = torques_over(drop_the_first(answer, sender), &[]);
    let descriptions =
        ["Identity", "LawDescription", "ParameterDescription", "ChoiceDescription", "SignalDescription"];
    let [reset, subscribe, arm, start, stop] =
        [Reset::LAYOUT, Subscribe::LAYOUT, Arm::LAYOUT, Start::LAYOUT, Stop::LAYOUT]
            .map(|request| format!("answer to {:#04x}", request.kind));
    let run = [&reset, "ParameterReport", &subscribe, &arm, &start, "LineReport", &stop];
    assert_eq!(dropped.iter().collect::<Vec<_>>(), [&descriptions[..], &run].concat());
    assert_eq!(torques, torques_of_a_run("native", &[]));
}

#[test]
fn a_watchdog_trip_before_the_start_answer_is_retried() {
    // Longer than the timeout of the start, shorter than the time to the second stop: the first stop is lost.
    let settings = ["controller.parameters.watchdog_us=750000"];
    let (sender, receiver) = mpsc::channel();
    let (mut is_first_start, mut is_first_stop) = (true, true);
    let torques = torques_over(
        move |frame| match frame.from_drive() {
            Some(DriveMessage::CommandResult(result))
                if result.request == Start::LAYOUT.kind && std::mem::take(&mut is_first_start) =>
            {
                drop_frame()
            }
            None if request(frame) == Some(Stop::LAYOUT.name) && std::mem::take(&mut is_first_stop) => {
                drop_frame()
            }
            // The fault report is lost too, so that only the state shows the fault.
            Some(DriveMessage::FaultReport(fault)) => {
                let _ = sender.send(fault.code);
                drop_frame()
            }
            _ => Action::Forward,
        },
        &settings,
    );
    let faults: Vec<_> = receiver.iter().collect();
    // The report follows every identity while the fault is latched.
    assert!(!faults.is_empty() && faults.iter().all(|code| *code == FaultCode::Watchdog), "{faults:?}");
    assert_eq!(torques, torques_of_a_run("native", &settings));
}

#[test]
fn a_run_survives_the_loss_of_the_last_stop_and_its_answers() {
    // The request, the line report, the result: one of them per run.
    let is_hit: [fn(&Transit) -> bool; 3] = [
        |frame| matches!(frame.from_bench(), Some(HostMessage::Stop(_))),
        |frame| matches!(frame.from_drive(), Some(DriveMessage::LineReport(_))),
        |frame| matches!(frame.from_drive(), Some(DriveMessage::CommandResult(it)) if it.request == Stop::LAYOUT.kind),
    ];
    let undisturbed = torques_of_a_run("native", &[]);
    for is_hit in is_hit {
        let mut is_first = true;
        let torques = torques_over(
            move |frame| {
                if is_hit(frame) && std::mem::take(&mut is_first) { drop_frame() } else { Action::Forward }
            },
            &[],
        );
        assert_eq!(torques, undisturbed);
    }
}

#[test]
fn an_unanswered_first_sample_is_retransmitted_unchanged() {
    const LOST: usize = 3;
    let (sender, receiver) = mpsc::channel();
    let mut answers = 0;
    let _ = torques_over(
        move |frame| {
            if let Some(sample) = frame.sample() {
                let _ = sender.send((sample, answers > LOST));
            }
            let is_answer = frame.torque().is_some();
            answers += usize::from(is_answer);
            if is_answer && answers <= LOST { drop_frame() } else { Action::Forward }
        },
        &["link.answer_timeout_ms=500", "allow.lost=10", "run.duration_s=0.01"],
    );
    let samples: Vec<_> = receiver.iter().collect();
    let [(first, _), others @ ..] = &samples[..] else { panic!("no samples") };
    assert_eq!(first.sequence, 0);
    // A busy machine may keep the drive from answering for longer than the dropped answers do.
    let repeats = others.iter().take_while(|(sample, _)| sample == first).count();
    assert!(repeats >= LOST, "the same sample: {samples:?}");
    let is_answered = others[..repeats].iter().any(|&(_, is_answered)| is_answered);
    assert!(!is_answered, "no repeat once an answer has reached the bench: {samples:?}");
    let rest: Vec<_> = others[repeats..].iter().map(|(sample, _)| usize::from(sample.sequence)).collect();
    assert_eq!(rest, Vec::from_iter(repeats + 1..10), "periods since the first one was sent");
}

#[test]
fn an_unanswered_request_times_out_under_its_name() {
    let twin = Twin::start();
    let relay = Relay::start(twin.path(), |frame| {
        if request(frame) == Some(Start::LAYOUT.name) { drop_frame() } else { Action::Forward }
    });
    let ended = program::run(["run", &RUNS[1].scenario(), "--device", relay.device()]).with_code(4);
    assert!(ended.stderr.contains("the drive was silent for 3.5 s after Start"), "{}", ended.stderr);
}
