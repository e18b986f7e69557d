//! An independent codec in C, built on the committed header, reads and writes the same frames.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use lashloop_protocol::enums::{Outcome, State};
use lashloop_protocol::hex::Hex;
use lashloop_protocol::limits::MAX_TELEMETRY_VALUES;
use lashloop_protocol::message::{CommandResult, Telemetry};
use lashloop_protocol::wire::BodyError;
use lashloop_protocol::{
    DriveMessage, Frame, HostMessage, MAX_BODY, Message, Numbered, TelemetryValues, cobs,
};

use crate::data_sheet::body_of;
use crate::examples::{self, NUMBER};

const ROOT: &str = env!("CARGO_MANIFEST_DIR");

/// The compiled program; `None` without a C compiler. The omission is reported, and fails where omissions are not allowed.
fn program() -> Option<PathBuf> {
    let program = Path::new(env!("CARGO_TARGET_TMPDIR")).join("golden");
    let built = Command::new("cc")
        .args(["-std=c11", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-O1"])
        .args(["-I".as_ref(), Path::new(ROOT).join("include").as_os_str()])
        .args(["-o".as_ref(), program.as_os_str()])
        .arg(Path::new(ROOT).join("tests/c/golden.c"))
        .output();
    match built {
        Ok(output) => {
            let errors = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "cc rejects the header or golden.c:\n{errors}");
            Some(program)
        }
        Err(error) => {
            let notice = format!("SKIPPED: no C compiler to test lashloop.h with: `cc`: {error}");
            assert!(std::env::var_os("LASHLOOP_REQUIRE_EQUIPMENT").is_none(), "{notice}");
            // Not `eprintln!`, whose output is captured and shown for failed tests only.
            let _ = writeln!(std::io::stderr(), "{notice}");
            None
        }
    }
}

/// The frame of every message, with its kind, its number and the length of its body.
fn frame_cases<M: Message>(messages: &[M]) -> String {
    let mut cases = String::new();
    for message in messages {
        let (layout, frame) = (message.layout(), message.numbered_frame(NUMBER));
        let (number, len) = (if layout.has_number() { NUMBER } else { 0 }, body_of(message).len());
        let _ = writeln!(cases, "frame {} {number} {len} {}", layout.kind, Hex(&frame));
    }
    cases
}

/// The sample with every bit flipped in turn, truncated at every length, and with a flipped bit in the kind.
fn bad_cases() -> String {
    let good = HostMessage::from(examples::SAMPLE).frame();
    let mut cases = String::new();
    for bit in 0..good.len() * 8 {
        let mut bad = good.to_vec();
        bad[bit / 8] ^= 1 << (bit % 8);
        let _ = writeln!(cases, "bad {}", Hex(&bad));
    }
    for len in 1..good.len() {
        let _ = writeln!(cases, "bad {}", Hex(&good[..len]));
    }
    let mut body = good[..good.len() - 1].to_vec();
    cobs::unstuff(&mut body).expect("an encoded frame is valid");
    body[1] ^= 0x01;
    cobs::stuff(&mut body);
    body.push(0);
    let _ = writeln!(cases, "bad {}", Hex(&body));
    cases
}

fn value_cases() -> String {
    let (sample, torque) = (examples::SAMPLE, examples::TORQUE);
    let (sample_frame, torque_frame) =
        (HostMessage::from(sample).frame(), DriveMessage::from(torque).frame());
    format!(
        "sample {} {} {} {} {:x}\ntorque {} {} {:x} {} {} {}\n",
        Hex(&sample_frame),
        sample.sequence,
        sample.motor_counts,
        sample.load_counts,
        sample.reference_rad.to_bits(),
        Hex(&torque_frame),
        torque.sequence,
        torque.torque_nm.to_bits(),
        torque.status.state.byte(),
        torque.status.flags.bits(),
        torque.compute_tenths_us,
    )
}

/// Telemetry with each number of values.
fn telemetry_cases() -> String {
    let mut cases = String::new();
    let values: Vec<f32> = (0..MAX_TELEMETRY_VALUES).map(|at| 0.1 - at as f32).collect();
    for count in 1..=MAX_TELEMETRY_VALUES {
        let values = TelemetryValues::new(&values[..count]).expect("at most 13");
        let frame = DriveMessage::from(Telemetry { sequence: 258, values }).frame();
        let _ = write!(cases, "values {} 258 {count}", Hex(&frame));
        for value in values.as_slice() {
            let _ = write!(cases, " {:x}", value.to_bits());
        }
        cases.push('\n');
    }
    cases
}

/// A result with and without device time, of values with and without a name, with every number of bytes after it.
fn result_cases() -> String {
    let mut cases = String::new();
    let unknown = (Outcome::from_byte(77), State::from_byte(9));
    for (outcome, state) in [(Some(Outcome::Inconsistent), Some(State::Idle)), unknown] {
        let (outcome, state) = (outcome.expect("not 0"), state.expect("not 0"));
        for device_time_us in [None, Some(0x4030_2010)] {
            let result = CommandResult { request: 0x05, outcome, state, detail: 0x0403_0201, device_time_us };
            let message = DriveMessage::from(result);
            let mut body = body_of(&message);
            // A fourth byte after a result without device time would complete one.
            let longest = if device_time_us.is_none() { body.len() + 3 } else { MAX_BODY };
            while body.len() <= longest {
                assert_eq!(DriveMessage::decode_body(&body), Ok(Numbered { number: NUMBER, message }));
                let (outcome, state, time) = (outcome.byte(), state.byte(), device_time_us.unwrap_or(0));
                let has_time = u8::from(device_time_us.is_some());
                let values = format!("{outcome} {state} {} {has_time} {time}", result.detail);
                let _ = writeln!(cases, "result {} {NUMBER} 5 {values}", Hex(&Frame::around(&body)));
                body.push(0xa5);
            }
        }
    }
    cases
}

/// What a receiver of these messages makes of each of them cut or extended to every length, and of every kind.
fn taken_cases<M: Message>(sender: &str, messages: &[M]) -> String {
    let mut cases = String::new();
    let mut add = |body: &[u8]| {
        let (verdict, number) = match M::decode_body(body) {
            Ok(numbered) => ("known", numbered.number),
            Err(BodyError::UnknownKind { number, .. }) => ("unknown", number),
            Err(_) => ("refused", 0),
        };
        let _ = writeln!(cases, "taken {sender} {verdict} {number} {}", Hex(&Frame::around(body)));
    };
    for message in messages {
        let extended = [body_of(message), vec![0xa5; MAX_BODY]].concat();
        for len in 1..=MAX_BODY {
            add(&extended[..len]);
        }
    }
    for kind in 0..=u8::MAX {
        add(&[kind]);
        // Each byte is a value of any type of field.
        add(&[&[kind, NUMBER][..], &[0x11; MAX_BODY - 2]].concat());
    }
    cases
}

#[test]
fn c_reads_and_writes_the_golden_frames() {
    let Some(program) = program() else { return };
    let (host, drive) = (examples::from_host(), examples::from_drive());
    let cases = frame_cases(&host)
        + &frame_cases(&drive)
        + &bad_cases()
        + &value_cases()
        + &telemetry_cases()
        + &result_cases()
        + &taken_cases("host", &host)
        + &taken_cases("drive", &drive);
    let mut child = Command::new(&program)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("a compiled program starts");
    // The program exits at the first failed case, with the reason on standard error; the remaining cases can't be written then.
    let _ = child.stdin.take().expect("stdin is a pipe").write_all(cases.as_bytes());
    let output = child.wait_with_output().expect("the program ends when its input does");
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{errors}");
    let passed = String::from_utf8_lossy(&output.stdout);
    assert_eq!(passed.trim(), cases.lines().count().to_string(), "every case ran");
}
