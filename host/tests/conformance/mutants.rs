//! The real drive with something between it and the line that breaks a rule.

use std::time::{Duration, Instant};

use lashloop_bench::link::{Link, LinkError};
use lashloop_firmware::drive::{Drive, ManualClock};
use lashloop_protocol::frame::DELIMITER;
use lashloop_protocol::{Decoder, DriveMessage, HostMessage, Message};

/// What a broken drive remembers.
#[derive(Default)]
pub struct Past {
    /// The request that is being answered; `None` for a damaged frame and for what comes unasked.
    pub request: Option<HostMessage>,
    /// Whether what is being answered was damaged.
    pub damaged: bool,
    /// For whatever the variant wants to keep.
    pub number: u32,
    pub torque_nm: f32,
    pub kept: Option<HostMessage>,
    /// Counts from zero at which an encoder was at first in a run, and is now.
    pub counts: (i64, i64),
}

/// A way to be wrong.
#[derive(Clone, Copy)]
pub struct Variant {
    /// What it does, as a sentence.
    pub does: &'static str,
    /// The check that has to find out.
    pub caught_by: &'static str,
    /// What the drive is told in place of a request.
    pub hear: fn(&mut Past, HostMessage) -> Vec<HostMessage>,
    /// What the line gets in place of the answers to one frame.
    pub say: fn(&mut Past, Vec<DriveMessage>) -> Vec<DriveMessage>,
    /// Whether no time passes for the drive.
    pub timeless: bool,
}

impl Variant {
    /// The drive as it is.
    pub const MERZOUKI: Self = Self {
        does: "is right",
        caught_by: "",
        hear: |_, request| vec![request],
        say: |_, answers| answers,
        timeless: false,
    };
}

/// Device time that a request takes. Counted and not measured, so that no busy machine trips a watchdog.
const REQUEST: Duration = Duration::from_micros(500);
/// A moment past a deadline, because the watchdog lets the limit itself pass.
const PAST: Duration = Duration::from_micros(100);

/// A link to an altered drive in this process. Device time passes with requests and while the bench waits.
pub struct Altered {
    drive: Drive,
    clock: ManualClock,
    variant: Variant,
    past: Past,
    partial: Vec<u8>,
    said: Vec<u8>,
}

impl Altered {
    pub fn new(variant: Variant) -> Self {
        Self {
            drive: Drive::new("altered"),
            clock: ManualClock::default(),
            variant,
            past: Past::default(),
            partial: Vec::new(),
            said: Vec::new(),
        }
    }

    fn hear(&mut self, frame: &[u8]) {
        if !self.variant.timeless {
            self.clock.0 += REQUEST;
        }
        let request = Decoder::new().next::<HostMessage>(&mut &*frame);
        self.past.damaged = matches!(request, Some(Err(_)));
        self.past.request = request.and_then(Result::ok);
        let altered = match self.past.request {
            Some(request) => (self.variant.hear)(&mut self.past, request)
                .iter()
                .flat_map(|request| request.frame().to_vec())
                .collect(),
            None => frame.to_vec(),
        };
        let mut answers = Vec::new();
        let mut rest = &altered[..];
        while !rest.is_empty() {
            let used = self.drive.receive(rest, &self.clock);
            rest = &rest[used..];
            answers.extend(self.listen());
        }
        self.say(answers);
    }

    fn say(&mut self, answers: Vec<DriveMessage>) {
        for answer in (self.variant.say)(&mut self.past, answers) {
            self.said.extend_from_slice(&answer.frame());
        }
    }

    fn listen(&mut self) -> Vec<DriveMessage> {
        let (mut decoder, mut bytes) = (Decoder::new(), self.drive.output());
        let answers = std::iter::from_fn(|| decoder.next(&mut bytes)).map(|it| it.expect("a good frame"));
        let answers = answers.collect();
        self.drive.clear_output();
        answers
    }
}

impl Link for Altered {
    fn inner(&mut self) -> Option<&mut dyn Link> {
        None
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        for &byte in bytes {
            self.partial.push(byte);
            if byte == DELIMITER {
                let frame = std::mem::take(&mut self.partial);
                self.hear(&frame);
            }
        }
        Ok(())
    }

    /// Waits for the watchdog alone: everything else has been said when [`Link::send`] returns.
    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
        if self.said.is_empty()
            && let Some(due) = self.drive.next_tick()
            && !self.variant.timeless
        {
            let bearable = deadline.saturating_duration_since(Instant::now());
            let wait = (due + PAST).saturating_sub(self.clock.0).min(bearable);
            std::thread::sleep(wait);
            self.clock.0 += wait;
            self.drive.tick(self.clock.0);
            (self.past.request, self.past.damaged) = (None, false);
            let answers = self.listen();
            self.say(answers);
        }
        let count = self.said.len().min(buffer.len());
        buffer[..count].copy_from_slice(&self.said[..count]);
        self.said.drain(..count);
        Ok(count)
    }

    fn discard_input(&mut self) -> Result<(), LinkError> {
        self.said.clear();
        Ok(())
    }
}
