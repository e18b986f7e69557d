//! `lashloop decode` on streams as a serial tool would have caught them.

use std::fs;

use lashloop_decode::capture::pcapng;
use lashloop_protocol::Frame;
use lashloop_protocol::layout::Direction;

use crate::support::{example_frame, example_frames, lashloop, short_run, subscribed_frames, text};

fn decode(arguments: &[&str], input: &[u8]) -> String {
    let output = lashloop(&[&["decode"], arguments].concat(), input);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    text(&output.stdout).to_owned()
}

#[test]
fn every_pinned_message_is_shown_with_values_and_units() {
    insta::assert_snapshot!(decode(&["-"], &example_frames().concat()));
}

#[test]
fn every_pinned_message_is_a_line_of_json() {
    let lines = decode(&["-", "--json"], &example_frames().concat());
    for line in lines.lines() {
        serde_json::from_str::<serde_json::Value>(line).unwrap();
    }
    insta::assert_snapshot!(lines);
}

#[test]
fn telemetry_has_the_names_of_the_subscribed_signals() {
    let stream = subscribed_frames().concat();
    insta::assert_snapshot!(decode(&["-"], &stream));
    insta::assert_snapshot!(decode(&["-", "--json"], &stream));
}

#[test]
fn bad_frames_are_shown_with_their_reason_and_place() {
    let [hello, .., report] = &example_frames()[..] else { unreachable!() };
    let mut flipped = hello.clone();
    flipped[3] ^= 0x40;
    let noise = [&[7; 100][..], &[0]].concat();
    let stream = [
        &hello[..],
        &[0, 0],
        &flipped,
        &[9, 9, 0],
        &[2, 5, 0],
        &noise,
        &Frame::around(&[0x7e, 5]),
        report,
        &hello[..4],
    ];
    insta::assert_snapshot!(decode(&["-"], &stream.concat()));
    insta::assert_snapshot!(decode(&["-", "--json"], &stream.concat()));
}

#[test]
fn what_holds_no_good_frame_is_another_file() {
    let noise: Vec<u8> = (0..2_000_u32).map(|at| (at.wrapping_mul(2_654_435_761) >> 13) as u8).collect();
    let output = lashloop(&["decode", "-"], &noise);
    assert_eq!(output.status.code(), Some(2), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("-: not one good frame"), "{}", text(&output.stderr));
    assert!(text(&output.stdout).contains("0 messages; bad: "), "what is bad is shown all the same");
    let mixed = [&noise[..], &[0], &example_frames()[0]].concat();
    decode(&["-"], &mixed);
    let output = lashloop(&["decode", "-"], &[]);
    assert_eq!(output.status.code(), Some(2), "an empty file has no good frame either");
}

#[test]
fn a_capture_is_known_by_its_magic_from_a_file_and_from_a_pipe() {
    let mut capture = pcapng::file_header();
    let [sample, torque] = ["EncoderSample", "TorqueAnswer"].map(example_frame);
    pcapng::append_packet(&mut capture, 1_000_000_000, Direction::HostToDrive, &[0]);
    pcapng::append_packet(&mut capture, 1_000_000_250, Direction::HostToDrive, &sample);
    pcapng::append_packet(&mut capture, 3_000_000_000, Direction::DriveToHost, &torque[..7]);
    pcapng::append_packet(&mut capture, 3_000_000_001, Direction::DriveToHost, &torque);
    let table = decode(&["-"], &capture);
    insta::assert_snapshot!(table);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("any name");
    fs::write(&path, &capture).unwrap();
    assert_eq!(decode(&[path.to_str().unwrap()], &[]), table);
}

#[test]
fn a_real_run_has_no_bad_frame() {
    let run = short_run();
    let table = decode(&[run.capture.to_str().unwrap()], &[]);
    let last = table.lines().last().unwrap();
    assert!(last.ends_with("bad: 0 by CRC, 0 malformed, 0 oversized, 0 refused (0 bytes)"), "{last}");
}

#[test]
fn a_capture_that_breaks_off_shows_its_packets_and_ends_with_an_error() {
    let mut capture = pcapng::file_header();
    pcapng::append_packet(&mut capture, 0, Direction::HostToDrive, &example_frames()[0]);
    pcapng::append_packet(&mut capture, 0, Direction::HostToDrive, &example_frames()[1]);
    let output = lashloop(&["decode", "-"], &capture[..capture.len() - 3]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stdout).contains("Hello") && text(&output.stdout).contains("1 message;"));
    let report = text(&output.stderr);
    assert!(report.contains("breaks off within a block, after packet 1"), "{report}");
}
