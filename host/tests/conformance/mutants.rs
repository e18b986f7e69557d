//! Mutants: the real drive behind a filter on requests or answers that breaks one rule.

use std::time::{Duration, Instant};

use lashloop_bench::link::{Link, LinkError};
use lashloop_firmware::drive::{Clock, Drive, ManualClock};
use lashloop_protocol::frame::DELIMITER;
use lashloop_protocol::{Decoder, DriveMessage, HostMessage, Message};

use crate::laws::TestLaws;

/// State of a mutant between frames.
#[derive(Default)]
pub struct Memory {
    /// The request being answered; `None` for a damaged frame and for an unsolicited message.
    pub request: Option<HostMessage>,
    /// Whether the frame being answered was damaged.
    pub damaged: bool,
    /// Free for use by the variant.
    pub number: u32,
    pub torque_nm: f32,
    pub kept: Option<HostMessage>,
    /// Encoder counts from zero: at the start of the run, and now.
    pub counts: (i64, i64),
}

/// One broken rule.
#[derive(Clone, Copy)]
pub struct Variant {
    /// Behaviour of the mutant; the subject is `a drive that`.
    pub does: &'static str,
    /// Name of the check that must fail.
    pub caught_by: &'static str,
    /// Requests that reach the drive in place of one on the line.
    pub on_request: fn(&mut Memory, HostMessage) -> Vec<HostMessage>,
    /// Answers that reach the line in place of those to one frame.
    pub on_answers: fn(&mut Memory, Vec<DriveMessage>) -> Vec<DriveMessage>,
    /// Whether device time stands still.
    pub clock_stands: bool,
}

impl Variant {
    /// The unchanged drive.
    pub const UNCHANGED: Self = Self {
        does: "keeps every rule",
        caught_by: "",
        on_request: |_, request| vec![request],
        on_answers: |_, answers| answers,
        clock_stands: false,
    };
}

/// Device time of a request. It is simulated, so that a busy machine trips no watchdog.
const REQUEST: Duration = Duration::from_micros(500);
/// Time past a deadline: the watchdog trips beyond its limit, not at it.
const OVERSHOOT: Duration = Duration::from_micros(100);

/// A link to a mutant in this process. Device time passes with requests and while the bench waits.
pub struct Mutant {
    drive: Drive<TestLaws>,
    clock: ManualClock,
    variant: Variant,
    memory: Memory,
    partial: Vec<u8>,
    output: Vec<u8>,
}

impl Mutant {
    pub fn new(variant: Variant) -> Self {
        Self {
            drive: Drive::with_laws("mutant"),
            clock: ManualClock::default(),
            variant,
            memory: Memory::default(),
            partial: Vec::new(),
            output: Vec::new(),
        }
    }

    fn receive_frame(&mut self, frame: &[u8]) {
        if !self.variant.clock_stands {
            self.clock.advance(REQUEST);
        }
        let request = Decoder::new().next::<HostMessage>(&mut &*frame);
        self.memory.damaged = matches!(request, Some(Err(_)));
        self.memory.request = request.and_then(Result::ok);
        let forwarded = match self.memory.request {
            Some(request) => (self.variant.on_request)(&mut self.memory, request)
                .iter()
                .flat_map(|request| request.frame().to_vec())
                .collect(),
            None => frame.to_vec(),
        };
        let mut answers = Vec::new();
        let mut rest = &forwarded[..];
        while !rest.is_empty() {
            let used = self.drive.receive(rest, &self.clock);
            rest = &rest[used..];
            answers.extend(self.drain());
        }
        self.queue(answers);
    }

    fn queue(&mut self, answers: Vec<DriveMessage>) {
        for answer in (self.variant.on_answers)(&mut self.memory, answers) {
            self.output.extend_from_slice(&answer.frame());
        }
    }

    fn drain(&mut self) -> Vec<DriveMessage> {
        let (mut decoder, mut bytes) = (Decoder::new(), self.drive.output());
        let answers = std::iter::from_fn(|| decoder.next(&mut bytes)).map(|it| it.expect("a good frame"));
        let answers = answers.collect();
        self.drive.clear_output();
        answers
    }
}

impl Link for Mutant {
    fn inner(&mut self) -> Option<&mut dyn Link> {
        None
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        for &byte in bytes {
            self.partial.push(byte);
            if byte == DELIMITER {
                let frame = std::mem::take(&mut self.partial);
                self.receive_frame(&frame);
            }
        }
        Ok(())
    }

    /// Waits for the watchdog alone: everything else has been output when [`Link::send`] returns.
    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
        if self.output.is_empty()
            && let Some(due) = self.drive.next_tick()
            && !self.variant.clock_stands
        {
            let patience = deadline.saturating_duration_since(Instant::now());
            let wait = (due + OVERSHOOT).saturating_sub(self.clock.now()).min(patience);
            std::thread::sleep(wait);
            self.clock.advance(wait);
            self.drive.tick(self.clock.now());
            (self.memory.request, self.memory.damaged) = (None, false);
            let answers = self.drain();
            self.queue(answers);
        }
        let count = self.output.len().min(buffer.len());
        buffer[..count].copy_from_slice(&self.output[..count]);
        self.output.drain(..count);
        Ok(count)
    }

    fn discard_input(&mut self) -> Result<(), LinkError> {
        self.output.clear();
        Ok(())
    }
}
