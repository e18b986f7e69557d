//! A drive between a UART and its USB port.

use std::collections::VecDeque;

use lashloop_firmware::usb::{ByteLine, CHUNK_BYTES, Chunk, HostSide, Lines};
use lashloop_protocol::enums::State;
use lashloop_protocol::frame::DELIMITER;
use lashloop_protocol::message::{Arm, Hello, Reset, Start, Stop};
use lashloop_protocol::{HostMessage, Message};
use tests::usb::bus::{Bus, BusEvent};

use crate::host::Host;
use crate::{COMMAND_RESULT, TRANSFER, hello};

/// A UART whose far end is the test, with a transmit buffer of some bytes.
pub(crate) struct Uart {
    to_drive: VecDeque<u8>,
    space: usize,
    loaded: Vec<u8>,
    sent: Vec<u8>,
}

impl Uart {
    fn with_space(space: usize) -> Self {
        Self { to_drive: VecDeque::new(), space, loaded: Vec::new(), sent: Vec::new() }
    }
}

impl ByteLine for Uart {
    fn take(&mut self) -> Chunk {
        let count = self.to_drive.len().min(CHUNK_BYTES);
        self.to_drive.drain(..count).collect()
    }

    fn load(&mut self, bytes: &[u8]) -> usize {
        let count = bytes.len().min(self.space - self.loaded.len());
        self.loaded.extend(&bytes[..count]);
        count
    }

    fn send(&mut self) {
        self.sent.append(&mut self.loaded);
    }
}

type TwoLines = Host<Lines<'static, Uart, Bus>>;

fn start() -> TwoLines {
    let mut host = Host::next_to(Uart::with_space(10));
    host.open_port();
    host
}

/// Sends bytes to the drive by the UART and returns what it sends back there.
fn by_uart(host: &mut TwoLines, bytes: &[u8]) -> Vec<u8> {
    host.port.uart().to_drive.extend(bytes);
    host.serve();
    std::mem::take(&mut host.port.uart().sent)
}

fn by_usb(host: &mut TwoLines, bytes: &[u8]) -> Option<Vec<u8>> {
    host.send(bytes);
    host.receive(TRANSFER)
}

/// The answer of a drive with this session, without a line.
fn answer() -> Vec<u8> {
    let mut direct = start();
    direct.drive.receive(&hello(), &direct.clock);
    direct.drive.output().to_vec()
}

fn begin_run(host: &mut TwoLines) {
    let session = 7;
    for message in [HostMessage::from(Arm { session }), Start { session }.into()] {
        by_usb(host, &message.frame()).expect("an answer");
    }
    assert_eq!(host.drive.state(), State::Running);
}

#[test]
fn an_answer_goes_to_the_line_of_its_request() {
    let mut host = start();
    assert_eq!(by_uart(&mut host, &hello()), answer());
    assert_eq!(host.receive(TRANSFER), None, "nothing for the other host");
    // A delimiter ends a frame that was cut at the last change.
    assert_eq!(by_usb(&mut host, &hello()).as_deref(), Some(&[DELIMITER][..]));
    assert_eq!(host.receive(TRANSFER), Some(answer()));
    assert_eq!(by_uart(&mut host, &hello()), [&[DELIMITER][..], &answer()].concat());
}

#[test]
fn a_line_that_stays_served_gets_no_delimiters() {
    let mut host = start();
    for _ in 0..3 {
        assert_eq!(by_uart(&mut host, &hello()), answer());
    }
}

#[test]
fn the_other_line_is_ignored_during_a_run_and_served_after_the_watchdog() {
    let mut host = start();
    by_usb(&mut host, &hello()).expect("an answer");
    begin_run(&mut host);
    let intruder = HostMessage::from(Hello::new(8)).frame();
    assert_eq!(by_uart(&mut host, &intruder), [0; 0]);
    assert_eq!(host.drive.state(), State::Running);
    // The host sends nothing more.
    host.signal(BusEvent::Suspend);
    host.drive.tick(std::time::Duration::from_secs(60));
    assert_eq!(host.drive.state(), State::Faulted);
    assert_ne!(by_uart(&mut host, &hello()), [0; 0]);
}

#[test]
fn usb_is_ignored_during_a_run_of_the_uart() {
    let mut host = start();
    by_uart(&mut host, &hello());
    let session = 7;
    for message in [HostMessage::from(Arm { session }), Start { session }.into()] {
        by_uart(&mut host, &message.frame());
    }
    assert_eq!(by_usb(&mut host, &HostMessage::from(Reset {}).frame()), None);
    assert_eq!((host.drive.state(), host.unread()), (State::Running, 0));
    by_uart(&mut host, &HostMessage::from(Stop {}).frame());
    assert_eq!(host.drive.state(), State::Idle, "the request is not followed after the run either");
}

#[test]
fn output_that_a_line_has_not_sent_does_not_reach_the_other() {
    let mut host = start();
    // The host of the port has requested, but reads nothing.
    host.send(&hello());
    let answered = by_uart(&mut host, &HostMessage::from(Reset {}).frame());
    assert_eq!(answered.len(), 1 + COMMAND_RESULT, "a delimiter and one result: {answered:?}");
}

#[test]
fn a_closed_port_leaves_the_uart_alone() {
    let mut host = start();
    host.set_dtr(false);
    assert_eq!(host.port.usb().map(lashloop_firmware::usb::UsbLine::host_side), Some(HostSide::Closed));
    assert_eq!(by_uart(&mut host, &hello()), answer());
}

#[test]
fn many_requests_at_once_are_all_answered_through_a_small_buffer() {
    let mut host = start();
    let requests = hello().repeat(50);
    assert_eq!(by_uart(&mut host, &requests), answer().repeat(50));
}
