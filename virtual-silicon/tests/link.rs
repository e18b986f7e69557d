//! USART2 of the bench image: bytes leave by interrupt.

use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::Duration;

use lashloop_protocol::Frame;
use lashloop_protocol::message::{FaultReport, Hello, Identity};
use lashloop_protocol::wire::Payload;
use lashloop_silicon::boards;
use lashloop_silicon::machine::{self, Ended};
use lashloop_silicon::pins::Pins;
use lashloop_silicon::surroundings::{End, Surroundings};
use lashloop_silicon::symbols::Symbols;
use object::{File, Object, ObjectSection};

/// Length of the answer to a `Hello` and of a fault report, with the delimiter.
const IDENTITY_BYTES: usize = Identity::LAYOUT.frame_len();
const FAULT_REPORT_BYTES: usize = FaultReport::LAYOUT.frame_len();
/// A byte on the line: 10 bits of 42 MHz by 46.
const BYTE: Duration = Duration::from_nanos(10_953);
const CYCLES_PER_SECOND: f64 = 168e6;
/// Device time at which the image has been up for long.
const BOOTED_AT: Duration = Duration::from_millis(20);
/// Device time that the answers have.
const LONG: Duration = Duration::from_millis(40);

fn file() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../target/lashloop-firmware.elf")
}

fn image() -> Symbols {
    Symbols::read(&file()).expect("`cargo xtask image` builds the image")
}

/// The image with the first millisecond as an unexpected exception: the vector of SysTick is that of a bus fault.
fn failing_image() -> Symbols {
    const WORD: usize = 4;
    let [bus_fault, sys_tick] = [5 * WORD, 15 * WORD];
    let mut bytes = fs::read(file()).expect("the image");
    let vectors = {
        let elf = File::parse(&bytes[..]).expect("an ELF file");
        let section = elf.section_by_name(".vector_table").expect("the vector table");
        section.file_range().expect("a place in the file").0 as usize
    };
    bytes.copy_within(vectors + bus_fault..vectors + bus_fault + WORD, vectors + sys_tick);
    let path = file().with_file_name("failing-image.elf");
    fs::write(&path, bytes).expect("a file");
    Symbols::read(&path).expect("an image")
}

/// Acts at instants, one after the other, and collects what the chip sends.
struct Script {
    actions: Vec<(Duration, Action)>,
    received: Vec<u8>,
}

type Action = Box<dyn FnMut(&mut Pins<'_>) + Send>;

impl Surroundings for Script {
    fn turn(&mut self, chip: &mut Pins<'_>) -> ControlFlow<End, Duration> {
        if self.actions.first().is_some_and(|(at, _)| chip.now() >= *at) {
            let (_, mut act) = self.actions.remove(0);
            act(chip);
        }
        self.received.extend(chip.serial_line().take());
        match self.actions.first() {
            Some((at, _)) => ControlFlow::Continue((*at).max(chip.now() + Duration::from_nanos(1))),
            None => ControlFlow::Break(End::Done),
        }
    }
}

fn run(image: &Symbols, actions: Vec<(Duration, Action)>) -> Ended<Script> {
    let script = Script { actions, received: Vec::new() };
    let wiring = boards::open(boards::DEFAULT).expect("the board");
    let ended = machine::run(image.image().expect("an image"), wiring, script).expect("a run");
    assert!(ended.violations.is_empty(), "{}", ended.violations);
    ended
}

fn send(requests: usize) -> Action {
    let hello = Frame::of(&Hello::new(0x4c41_5348));
    Box::new(move |chip| chip.serial_line().send(&hello.repeat(requests)))
}

fn nothing() -> Action {
    Box::new(|_| {})
}

#[test]
fn the_core_does_not_wait_for_the_line() {
    let (image, requests) = (image(), 20);
    // The answers, one after the other without a pause, and a little more.
    let time = BYTE * (requests * IDENTITY_BYTES) as u32 * 6 / 5;
    let [idle, busy] = [0, requests]
        .map(|requests| run(&image, vec![(BOOTED_AT, send(requests)), (BOOTED_AT + time, nothing())]));
    let bytes = busy.surroundings.received.len() - idle.surroundings.received.len();
    assert_eq!(bytes, requests * IDENTITY_BYTES);
    let instructions = (busy.instructions - idle.instructions) as f64;
    let cycles_of_line = bytes as f64 * BYTE.as_secs_f64() * CYCLES_PER_SECOND;
    println!("{instructions} instructions, {cycles_of_line:.0} cycles of the line for {bytes} bytes");
    assert!(instructions < 0.25 * cycles_of_line, "{instructions} instructions in {cycles_of_line} cycles");
}

#[test]
fn a_delimiter_ends_the_frame_that_a_fault_cuts() {
    // The requests wait at the receiver, so the line is busy in the first millisecond.
    let ended = run(&failing_image(), vec![(Duration::ZERO, send(40)), (LONG, nothing())]);
    let received = ended.surroundings.received;
    assert!(received.ends_with(&[0]), "{received:02x?}");
    let mut frames = received[..received.len() - 1].rsplit(|byte| *byte == 0);
    assert_eq!(frames.next().map(<[u8]>::len), Some(FAULT_REPORT_BYTES - 1), "{received:02x?}");
    let cut = frames.next().map_or(0, <[u8]>::len);
    assert!((1..IDENTITY_BYTES - 1).contains(&cut), "the frame was cut after {cut} bytes: {received:02x?}");
    assert!(frames.all(|frame| frame.len() == IDENTITY_BYTES - 1), "{received:02x?}");
}
