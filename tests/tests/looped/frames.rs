//! The first frames of a run as bytes, taken off the line.

use std::sync::mpsc;

use lashloop_protocol::enums::{State, TorqueFlags, TorqueStatus};
use lashloop_protocol::hex::Hex;
use tests::bench;
use tests::paper::RUNS;
use tests::relay::{Passing, Relay, StepOutcome};
use tests::twin::Twin;

/// The first frame of each kind asked for in a run of two steps.
fn first(wanted: [fn(&Passing) -> bool; 2]) -> [Passing; 2] {
    let twin = Twin::start();
    let (tell, told) = mpsc::channel();
    let relay = Relay::start(twin.path(), move |frame| {
        let _ = tell.send(frame.clone());
        StepOutcome::Pass
    });
    // Two steps can't settle, so the verdict is FAIL.
    let scenario = RUNS[1].scenario();
    let _ = bench::run(["run", &scenario, "--device", relay.device(), "--set", "run.duration_s=0.002"])
        .with_code(1);
    drop(relay);
    let frames: Vec<Passing> = told.into_iter().collect();
    wanted.map(|wanted| frames.iter().find(|frame| wanted(frame)).expect("such a frame").clone())
}

#[test]
fn the_first_sample_and_the_first_torque_have_these_bytes() {
    let [sample, torque] = first([|frame| frame.sample().is_some(), |frame| frame.torque().is_some()]);

    // code, kind, sequence 0, motor counts 98304, load counts 32768, reference 0.0, CRC, delimiter: the load at pi/2 and
    // the motor at 3 pi/2 are a quarter and three quarters of 131,072 counts.
    assert_eq!(
        format!("{:#}", Hex(&sample.bytes)),
        "02 10 01 01 03 80 01 02 80 01 01 01 01 05 bd 77 10 4c 00"
    );

    // code, kind, sequence 0, torque, state Running without flags. The time the drive took follows, which no test can
    // know, and with it the distance from the sequence's second zero to the next; then CRC and delimiter.
    assert_eq!(torque.bytes.len(), 16);
    assert_eq!(format!("{:#}", Hex(&torque.bytes[..3])), "02 90 01");
    assert_eq!(format!("{:#}", Hex(&torque.bytes[4..9])), "85 5d a3 c1 04");
    let answer = torque.torque().expect("a torque");
    let status = TorqueStatus { state: State::Running, flags: TorqueFlags::empty() };
    assert_eq!((answer.sequence, answer.status), (0, status));
}
