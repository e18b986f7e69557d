//! A drive in process whose answers are altered on the way.

use std::time::{Duration, Instant};

use lashloop_conformance::{CheckResult, CheckStatus, Reporter, TIME_LIMIT, run};
use lashloop_link::in_process::InProcess;
use lashloop_link::{Link, LinkError};
use lashloop_protocol::limits::FLAG_NAMES;
use lashloop_protocol::message::{ChoiceDescription, DescribeChoice};
use lashloop_protocol::text::Text;
use lashloop_protocol::{Decoder, DriveMessage, HostMessage, Message, Numbered};
use lashloop_session::SessionError;

/// A flag that a newer drive adds, and one of this version.
pub const NEW_FLAG: u8 = 0x80;
const KNOWN_FLAG: u8 = 0x40;

/// What arrives instead of a message, as bytes.
pub type Alteration = fn(&Numbered<DriveMessage>, Passing) -> Vec<u8>;

/// What has passed a middleware.
#[derive(Clone, Copy, Default)]
pub struct Passing {
    pub requests: u32,
    /// Device time of the last message that has one.
    pub device_us: Option<u32>,
}

/// A middleware that alters the drive's messages, each after a delay.
pub struct Altered {
    drive: Box<dyn Link>,
    decoder: Decoder,
    alter: Alteration,
    /// Numbers of requests for the name of [`NEW_FLAG`].
    of_new_flag: Vec<u8>,
    delay: Duration,
    /// Writes from one standstill of the bench to the next, and how long it lasts.
    pauses: Option<(u32, Duration)>,
    /// The write at which the line stands still, and how long.
    standstill: Option<(u32, Duration)>,
    /// When the line continues.
    goes_on: Option<Instant>,
    /// Since when the drive's program has waited for a core.
    starved_since: Option<Instant>,
    writes: u32,
    passing: Passing,
    waiting: Vec<u8>,
}

impl Altered {
    pub fn new(alter: Alteration) -> Self {
        Self::over(Box::new(InProcess::<lashloop_firmware::Laws>::default()), alter)
    }

    pub fn over(drive: Box<dyn Link>, alter: Alteration) -> Self {
        Self {
            drive,
            decoder: Decoder::new(),
            alter,
            of_new_flag: Vec::new(),
            delay: Duration::ZERO,
            pauses: None,
            standstill: None,
            goes_on: None,
            starved_since: None,
            writes: 0,
            passing: Passing::default(),
            waiting: Vec::new(),
        }
    }

    /// Every answer takes this long.
    pub fn slow(delay: Duration) -> Self {
        Self { delay, ..Self::unaltered() }
    }

    /// Every answer takes this long, because the drive's program waits for a core.
    pub fn starved(delay: Duration) -> Self {
        let mut slow = Self::slow(delay);
        slow.starved_since = Some(slow.drive.now());
        slow
    }

    /// The bench stands still for `pause` before one write in `writes`.
    pub fn on_a_busy_bench(writes: u32, pause: Duration) -> Self {
        Self { pauses: Some((writes, pause)), ..Self::unaltered() }
    }

    /// Answers stay on their way for `time` from write number `write` on.
    pub fn standing_still(write: u32, time: Duration) -> Self {
        Self { standstill: Some((write, time)), ..Self::unaltered() }
    }

    fn unaltered() -> Self {
        Self::new(|it, _| it.message.numbered_frame(it.number).to_vec())
    }
}

impl Link for Altered {
    fn inner(&mut self) -> Option<&mut dyn Link> {
        Some(&mut *self.drive)
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.writes += 1;
        if let Some((_, pause)) = self.pauses.filter(|(writes, _)| self.writes.is_multiple_of(*writes)) {
            let until = self.drive.now() + pause;
            self.drive.wait_until(until)?;
        }
        if let Some((_, time)) = self.standstill.filter(|(write, _)| self.writes == *write) {
            self.goes_on = Some(self.drive.now() + time);
        }
        let mut decoder = Decoder::new();
        let mut rest = bytes;
        let mut known = bytes.to_vec();
        while let Some(frame) = decoder.next::<HostMessage>(&mut rest) {
            self.passing.requests += u32::from(frame.is_ok());
            if let Ok(Numbered { number, message }) = frame
                && message == name_of(NEW_FLAG).into()
            {
                self.of_new_flag.push(number);
                known = with_flag_known(&known, number);
            }
        }
        self.drive.send(&known)
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
        if let Some(goes_on) = self.goes_on {
            self.drive.wait_until(goes_on.min(deadline))?;
            if goes_on > deadline {
                return Ok(0);
            }
            self.goes_on = None;
        }
        while self.waiting.is_empty() {
            let mut bytes = [0; 1024];
            let count = self.drive.receive(&mut bytes, deadline)?;
            if count == 0 {
                return Ok(0);
            }
            let mut rest = &bytes[..count];
            while let Some(message) = self.decoder.next::<DriveMessage>(&mut rest) {
                let mut message = message.expect("a drive that sends good frames");
                if let DriveMessage::ChoiceDescription(it) = &mut message.message
                    && (it.parameter, it.choice) == (FLAG_NAMES, KNOWN_FLAG)
                    && self.of_new_flag.contains(&message.number)
                {
                    *it = ChoiceDescription { choice: NEW_FLAG, name: Text::new("NEW"), ..*it };
                }
                self.passing.device_us =
                    { message.message }.device_time_us_mut().and_then(|it| *it).or(self.passing.device_us);
                self.waiting.extend((self.alter)(&message, self.passing));
            }
            let until = self.drive.now() + self.delay;
            self.drive.wait_until(until)?;
        }
        let count = self.waiting.len().min(buffer.len());
        buffer[..count].copy_from_slice(&self.waiting[..count]);
        self.waiting.drain(..count);
        Ok(count)
    }

    fn starved(&mut self) -> Duration {
        let now = self.drive.now();
        self.starved_since.map_or(Duration::ZERO, |since| now - since)
    }

    fn discard_input(&mut self) -> Result<(), LinkError> {
        if self.goes_on.is_some_and(|goes_on| goes_on > self.drive.now()) {
            // Nothing has arrived yet.
            return Ok(());
        }
        self.waiting.clear();
        self.drive.discard_input()
    }
}

const fn name_of(flag: u8) -> DescribeChoice {
    DescribeChoice { parameter: FLAG_NAMES, choice: flag }
}

/// Bytes in which the request for the name of [`NEW_FLAG`] asks for another one, so that the drive answers it.
fn with_flag_known(bytes: &[u8], number: u8) -> Vec<u8> {
    let [new, known] =
        [NEW_FLAG, KNOWN_FLAG].map(|flag| HostMessage::from(name_of(flag)).numbered_frame(number));
    let at = bytes.windows(new.len()).position(|window| *window == *new).expect("the request");
    [&bytes[..at], &known, &bytes[at + new.len()..]].concat()
}

/// The results of a battery, and how it ended.
pub struct Battery {
    time_limit: Duration,
    pub results: Vec<CheckResult>,
    pub ended: Result<(), SessionError>,
}

impl Reporter for Battery {
    fn time_limit(&self) -> Duration {
        self.time_limit
    }

    fn checked(&mut self, result: &CheckResult) {
        self.results.push(result.clone());
    }
}

impl Battery {
    pub fn of(link: Altered) -> Self {
        Self::within(TIME_LIMIT, link)
    }

    pub fn within(time_limit: Duration, link: Altered) -> Self {
        let mut battery = Self { time_limit, results: Vec::new(), ended: Ok(()) };
        battery.ended = run(Box::new(link), 7, &mut battery);
        battery
    }

    /// The checks whose status has this property.
    pub fn with(&self, property: impl Fn(&CheckStatus) -> bool) -> Vec<&CheckResult> {
        self.results.iter().filter(|it| property(&it.status)).collect()
    }

    pub fn failed(&self) -> Vec<&CheckResult> {
        self.with(|status| matches!(status, CheckStatus::Failed { .. }))
    }

    pub fn not_judged(&self) -> Vec<&CheckResult> {
        self.with(|status| matches!(status, CheckStatus::NotJudged { .. }))
    }
}
