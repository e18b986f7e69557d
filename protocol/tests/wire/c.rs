//! A decoder and encoder in C, built on the committed header, reads and writes the same frames.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use lashloop_protocol::{Message, cobs};

use crate::examples;

const ROOT: &str = env!("CARGO_MANIFEST_DIR");

/// The compiled program; `None` where there is no C compiler, which is said aloud and allowed only if leaving things
/// out is.
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
            let said = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "cc does not take the header or golden.c:\n{said}");
            Some(program)
        }
        Err(error) => {
            let notice = format!("LEFT OUT: no C compiler to try lashloop.h with: `cc`: {error}");
            assert!(std::env::var_os("LASHLOOP_LEAVE_NOTHING_OUT").is_none(), "{notice}");
            // Not by `eprintln!`, which is captured and shown for tests that fail only.
            let _ = writeln!(std::io::stderr(), "{notice}");
            None
        }
    }
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The frame of every message, each with its kind and the length of its body.
fn frame_cases<M: Message>(messages: &[M]) -> String {
    let mut cases = String::new();
    for message in messages {
        let (layout, frame) = (message.layout(), message.frame());
        let _ = writeln!(cases, "frame {} {} {}", layout.kind, layout.body_len, hex(&frame));
    }
    cases
}

/// The sample with every bit flipped in turn, cut at every length, and around a body that a flip of the kind spoils.
fn bad_cases() -> String {
    let good = lashloop_protocol::HostMessage::from(examples::SAMPLE).frame();
    let mut cases = String::new();
    for bit in 0..good.len() * 8 {
        let mut bad = good.to_vec();
        bad[bit / 8] ^= 1 << (bit % 8);
        let _ = writeln!(cases, "bad {}", hex(&bad));
    }
    for len in 1..good.len() {
        let _ = writeln!(cases, "bad {}", hex(&good[..len]));
    }
    let mut body = good[..good.len() - 1].to_vec();
    cobs::unstuff(&mut body).expect("a frame of ours is stuffed as COBS asks");
    body[1] ^= 0x01;
    cobs::stuff(&mut body);
    body.push(0);
    let _ = writeln!(cases, "bad {}", hex(&body));
    cases
}

fn value_cases() -> String {
    let (sample, torque) = (examples::SAMPLE, examples::TORQUE);
    let (sample_frame, torque_frame) = (
        lashloop_protocol::HostMessage::from(sample).frame(),
        lashloop_protocol::DriveMessage::from(torque).frame(),
    );
    format!(
        "sample {} {} {} {} {:x}\ntorque {} {} {:x} {} {} {}\n",
        hex(&sample_frame),
        sample.sequence,
        sample.motor_counts,
        sample.load_counts,
        sample.reference_rad.to_bits(),
        hex(&torque_frame),
        torque.sequence,
        torque.torque_nm.to_bits(),
        torque.status.state as u8,
        torque.status.flags.bits(),
        torque.compute_tenths_us,
    )
}

#[test]
fn c_reads_and_writes_the_golden_frames() {
    let Some(program) = program() else { return };
    let cases = frame_cases(&examples::from_host())
        + &frame_cases(&examples::from_drive())
        + &bad_cases()
        + &value_cases();
    let mut child = Command::new(&program)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("what cc made can be run");
    // The program ends at the first case it does not like; then the rest can't be written, and its words tell why.
    let _ = child.stdin.take().expect("stdin is a pipe").write_all(cases.as_bytes());
    let output = child.wait_with_output().expect("the program ends when its input does");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    let passed = String::from_utf8_lossy(&output.stdout);
    assert_eq!(passed.trim(), cases.lines().count().to_string(), "every case was tried");
}
