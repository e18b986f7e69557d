//! An independent codec in C, built on the committed header, reads and writes the same frames.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use lashloop_protocol::hex::Hex;
use lashloop_protocol::limits::MAX_TELEMETRY_VALUES;
use lashloop_protocol::message::Telemetry;
use lashloop_protocol::{DriveMessage, HostMessage, MAX_FRAME, Message, TelemetryValues, cobs};

use crate::data_sheet::body_of;
use crate::examples;

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

/// The frame of every message, with its kind and the length of its body.
fn frame_cases<M: Message>(messages: &[M]) -> String {
    let mut cases = String::new();
    for message in messages {
        let (layout, frame) = (message.layout(), message.frame());
        let _ = writeln!(cases, "frame {} {} {}", layout.kind, body_of(message).len(), Hex(&frame));
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
        torque.status.state as u8,
        torque.status.flags.bits(),
        torque.compute_tenths_us,
    )
}

/// Telemetry with each number of values, and the lengths next to those of every kind.
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
    for layout in HostMessage::LAYOUTS.iter().chain(DriveMessage::LAYOUTS) {
        for len in (0..=MAX_FRAME).filter(|len| !layout.takes(*len)) {
            let _ = writeln!(cases, "length {} {len}", layout.kind);
        }
    }
    cases
}

#[test]
fn c_reads_and_writes_the_golden_frames() {
    let Some(program) = program() else { return };
    let cases = frame_cases(&examples::from_host())
        + &frame_cases(&examples::from_drive())
        + &bad_cases()
        + &value_cases()
        + &telemetry_cases();
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
