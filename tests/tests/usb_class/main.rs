//! The drive's USB port, packet by packet, on a bus in software, alone and next to a UART.

mod host;
mod lines;

use host::{Host, UsbHost};
use lashloop_firmware::usb::{HostSide, PACKET_BYTES};
use lashloop_protocol::counts::EncoderCounts;
use lashloop_protocol::enums::State;
use lashloop_protocol::message::{ClearFault, EncoderSample, Hello, Reset, Stop};
use lashloop_protocol::{HostMessage, Message};
use tests::usb::bus::BusEvent;

/// Length of a transfer that a host requests: several packets.
const TRANSFER: usize = 512;

fn hello() -> Vec<u8> {
    HostMessage::from(Hello::new(7)).frame().to_vec()
}

/// Frames of a drive: the answer to a sample, and the result of a request.
const TORQUE_ANSWER: usize = 16;
const COMMAND_RESULT: usize = 19;

fn sample() -> HostMessage {
    let [motor_counts, load_counts] = [EncoderCounts::wrapping(0); 2];
    EncoderSample { sequence: 1, motor_counts, load_counts, reference_rad: 0.0 }.into()
}

/// A host with an open port and a drive whose output has `length` bytes.
fn with_output(length: usize) -> UsbHost {
    let mut host = Host::new();
    host.open_port();
    host.drive.receive(&hello(), &host.clock);
    host.drive.clear_output();
    let (frame, request) = if length.is_multiple_of(TORQUE_ANSWER) {
        (TORQUE_ANSWER, sample())
    } else {
        (COMMAND_RESULT, HostMessage::from(ClearFault {}))
    };
    for _ in 0..length / frame {
        host.drive.receive(&request.frame(), &host.clock);
    }
    assert_eq!(host.drive.output().len(), length);
    host
}

#[test]
fn an_empty_packet_ends_output_of_whole_packets() {
    for length in [PACKET_BYTES, 2 * PACKET_BYTES] {
        let mut host = with_output(length);
        let output = host.drive.output().to_vec();
        assert_eq!(host.receive(TRANSFER), Some(output), "the transfer of {length} bytes ends");
    }
}

#[test]
fn output_waits_in_packets_of_64_bytes() {
    let mut host = with_output(5 * COMMAND_RESULT);
    let output = host.drive.output().to_vec();
    assert_eq!(host.receive(PACKET_BYTES).as_deref(), Some(&output[..PACKET_BYTES]));
    assert_eq!(host.receive(PACKET_BYTES).as_deref(), Some(&output[PACKET_BYTES..]));
    assert_eq!(host.receive(PACKET_BYTES), None, "nothing is left, not even an empty packet");
}

#[test]
fn the_drive_answers_as_on_any_other_line() {
    let (mut host, mut direct) = (Host::new(), Host::new());
    host.open_port();
    // The answer to `Stop` counts the frames, whole and damaged.
    for request in [hello(), HostMessage::from(Stop {}).frame().to_vec()] {
        host.send(&request);
        let answer = host.receive(TRANSFER).expect("an answer");
        direct.drive.clear_output();
        direct.drive.receive(&request, &direct.clock);
        assert_eq!(answer, direct.drive.output());
    }
}

#[test]
fn output_of_a_closed_port_is_discarded() {
    let mut host = with_output(3 * COMMAND_RESULT);
    host.set_dtr(false);
    assert_eq!(host.port.host_side(), HostSide::Closed);
    assert_eq!(host.drive.output(), [0; 0]);
    host.set_dtr(true);
    assert_eq!(host.receive(TRANSFER), None, "the next program starts without old frames");
}

#[test]
fn bytes_sent_just_ahead_of_closing_are_served() {
    let mut host = Host::new();
    host.open_port();
    host.submit(&hello());
    host.submit_dtr(false);
    host.serve();
    assert_eq!(host.drive.state(), State::Idle, "the drive has taken the Hello");
}

/// A host of a drive without space for an answer, so that a request to reset it waits in the port.
fn with_a_packet_that_waits() -> UsbHost {
    let mut host = Host::new();
    host.open_port();
    while host.drive.receive(&hello(), &host.clock) == hello().len() {}
    host.submit(&HostMessage::from(Reset {}).frame());
    host.port.poll();
    assert!(host.port.has_received(), "the drive has no space for an answer");
    host
}

#[test]
fn bytes_that_wait_for_a_drive_are_served_after_closing() {
    let mut host = with_a_packet_that_waits();
    host.submit_dtr(false);
    host.serve();
    assert_eq!(host.drive.state(), State::Boot);
}

#[test]
fn a_suspended_bus_discards_output_and_resumes_open() {
    let mut host = with_output(3 * COMMAND_RESULT);
    host.signal(BusEvent::Suspend);
    assert_eq!(host.port.host_side(), HostSide::Suspended);
    assert_eq!(host.drive.output(), [0; 0]);
    host.signal(BusEvent::Resume);
    assert_eq!(host.port.host_side(), HostSide::Open);
    host.send(&hello());
    assert!(host.receive(TRANSFER).is_some_and(|answer| answer.ends_with(&[0])));
}

#[test]
fn a_reset_detaches_and_drops_a_packet_that_waits() {
    let mut host = with_a_packet_that_waits();
    host.signal(BusEvent::Reset);
    assert_eq!(host.port.host_side(), HostSide::Detached);
    assert_eq!(host.drive.state(), State::Idle, "a request from before the reset is not followed");
    host.open_port();
    host.send(&hello());
    assert!(host.receive(TRANSFER).is_some(), "the port works after a replug");
}

#[test]
fn a_host_that_does_not_read_is_held_back_and_loses_nothing() {
    let mut host = Host::new();
    host.open_port();
    let request = hello();
    let requests = 200;
    for _ in 0..requests {
        host.submit(&request);
    }
    host.serve();
    assert!(host.unread() > requests / 2, "the bus rejects packets while the drive has no space");
    let mut answers = Vec::new();
    while let Some(bytes) = host.receive(PACKET_BYTES) {
        answers.extend(bytes);
    }
    assert_eq!(host.unread(), 0);
    let identities = answers.split(|byte| *byte == 0).filter(|frame| !frame.is_empty()).count();
    assert_eq!(identities, requests, "one answer for each request");
}

#[test]
fn a_zero_length_packet_of_the_host_is_no_byte() {
    let mut host = Host::new();
    host.open_port();
    host.submit(&[]);
    host.send(&hello());
    assert!(host.receive(TRANSFER).is_some());
    host.send(&HostMessage::from(Reset {}).frame());
    assert_eq!(host.drive.state(), State::Boot);
}

#[test]
fn an_unknown_request_is_rejected_and_the_port_goes_on() {
    let mut host = Host::new();
    host.open_port();
    assert!(host.control([0xc0, 0x77, 0, 0, 0, 0, 8, 0], 8).is_none(), "stalled");
    host.send(&hello());
    assert!(host.receive(TRANSFER).is_some());
}
