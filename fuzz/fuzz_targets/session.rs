//! A session with a hostile drive ends with a result or an error within its limits of time, and no text of the drive reaches a
//! terminal as it is.
//!
//! The drive is a true one in process, so that a session gets anywhere; the input edits what it sends. Each edit is a byte, whose low
//! five bits are the number of frames that pass before it and whose highest three bits are the kind of edit, then the bytes of the edit.

#![no_main]

use std::time::{Duration, Instant};

use lashloop_firmware::control::merzouki::Merzouki;
use lashloop_firmware::control::pd::Pd;
use lashloop_link::in_process::InProcess;
use lashloop_link::{Link, LinkError};
use lashloop_protocol::message::EncoderSample;
use lashloop_protocol::{Decoder, DriveMessage, EncoderCounts, Frame, MAX_FRAME, Message, frame};
use lashloop_session::{Session, SessionError};
use libfuzzer_sys::fuzz_target;

/// Parameters and signals that the drive admits to: up to `torque_limit_nm`, and one; with an input of even length none, so that its
/// edits meet the run. Most of a session is their descriptions, and each takes the same way.
const ADMITTED: [(u8, u8); 2] = [(0, 0), (6, 1)];
/// [`PATIENCE`](lashloop_session::PATIENCE) up to the start, and as much again for the stop and for what a limit oversteps.
const LONGEST_SESSION: Duration = Duration::from_secs(40);
/// More reads than any session needs in that time.
const MOST_READS: u32 = 100_000;

lashloop_firmware::laws! {
    /// Two laws, so that the parameter of the law in force has names.
    enum Laws {
        /// In force after power-up.
        Pd(Pd),
        /// The other one.
        Merzouki(Merzouki),
    }
}

fuzz_target!(|input: &[u8]| {
    let link = Hostile::new(input);
    if let Err(error) = converse(Box::new(link)) {
        let text = error.to_string();
        assert!(!text.is_empty());
        assert!(!text.chars().any(char::is_control), "{text:?}");
    }
});

/// Handshake, descriptions, a setting, a few periods and a stop.
fn converse(link: Box<dyn Link>) -> Result<(), SessionError> {
    let mut session = Session::open(link, 1)?;
    let texts = session.laws.iter().map(|law| law.name.to_string());
    let texts = texts.chain(session.parameters.iter().map(|parameter| parameter.name.to_string()));
    for name in texts.chain(session.signals.iter().map(|signal| signal.signal.name.to_string())) {
        assert!(!name.chars().any(char::is_control), "{name:?}");
    }
    if let Err(error) = session.set("torque_limit_nm", 2.0) {
        assert!(!error.to_string().chars().any(char::is_control), "{error}");
    }
    session.start()?;
    for step in 0..3 {
        let [motor_counts, load_counts] = [EncoderCounts::default(); 2];
        let sample = EncoderSample { sequence: 0, motor_counts, load_counts, reference_rad: 0.1 };
        let deadline = session.line.now() + Duration::from_millis(1);
        session.exchange(step, &sample, deadline)?;
    }
    session.stop()
}

struct Hostile {
    drive: InProcess<Laws>,
    started: Option<Instant>,
    reads: u32,
    edits: std::vec::IntoIter<u8>,
    /// Frames to pass before the next edit; `None` after the last one.
    passing: Option<u8>,
    edit: u8,
    /// Edited and not read yet.
    ready: Vec<u8>,
    /// Reads that give one byte of noise each, a millisecond apart.
    babble: u32,
    /// Whether the drive has passed an `Identity`.
    is_introduced: bool,
    admitted: (u8, u8),
}

impl Hostile {
    fn new(input: &[u8]) -> Self {
        let mut hostile = Self {
            drive: InProcess::default(),
            started: None,
            reads: 0,
            edits: input.to_vec().into_iter(),
            passing: None,
            edit: 0,
            ready: Vec::new(),
            babble: 0,
            is_introduced: false,
            admitted: ADMITTED[input.len() % 2],
        };
        hostile.next_edit();
        hostile
    }

    /// The frame, with fewer parameters and signals if it is an `Identity`.
    fn introduction<'a>(&mut self, sent: &'a [u8], shorter: &'a mut [u8; MAX_FRAME]) -> &'a [u8] {
        match Decoder::new().next::<DriveMessage>(&mut &*sent) {
            Some(Ok(mut answer)) => {
                let DriveMessage::Identity(identity) = &mut answer.message else { return sent };
                (identity.parameter_count, identity.signal_count) = self.admitted;
                self.is_introduced = true;
                answer.message.write_numbered(answer.number, shorter)
            }
            _ => sent,
        }
    }

    fn next_edit(&mut self) {
        let head = self.edits.next();
        self.passing = head.map(|head| head & 0x1f);
        self.edit = head.map_or(0, |head| head >> 5);
    }

    fn byte(&mut self) -> u8 {
        self.edits.next().unwrap_or_default()
    }

    /// Appends a frame of the drive to what is ready, edited if it is its turn.
    fn pass(&mut self, sent: &[u8]) {
        let mut shorter = [0; MAX_FRAME];
        let sent = if self.is_introduced { sent } else { self.introduction(sent, &mut shorter) };
        match self.passing {
            Some(0) => {}
            Some(more) => {
                self.passing = Some(more - 1);
                return self.ready.extend_from_slice(sent);
            }
            None => return self.ready.extend_from_slice(sent),
        }
        match self.edit {
            0 => {}
            // One bit flipped.
            1 => {
                let at = self.byte();
                let mut sent = sent.to_vec();
                let index = usize::from(at / 8) % sent.len();
                sent[index] ^= 1 << (at % 8);
                self.ready.extend(sent);
            }
            // One byte replaced, with a correct CRC.
            2 | 3 => {
                let (at, value) = (self.byte(), self.byte());
                let mut stuffed = sent[..sent.len() - 1].to_vec();
                if let Ok(body) = frame::open(&mut stuffed) {
                    let mut body = body.to_vec();
                    let index = usize::from(at) % body.len();
                    body[index] = value;
                    self.ready.extend_from_slice(&Frame::around(&body));
                }
            }
            4 => self.ready.extend([sent, sent].concat()),
            // Another message before it.
            5 => {
                let kind = usize::from(self.byte()) % DriveMessage::LAYOUTS.len();
                let layout = DriveMessage::LAYOUTS[kind];
                let mut body = vec![layout.kind];
                body.extend((1..layout.body_len).map(|_| self.byte()));
                self.ready.extend_from_slice(&Frame::around(&body));
                self.ready.extend_from_slice(sent);
            }
            // Any bytes instead.
            6 => {
                let count = self.byte();
                let noise: Vec<u8> = (0..count).map(|_| self.byte()).collect();
                self.ready.extend(noise);
            }
            _ => self.babble = u32::from(self.byte()) << 4,
        }
        self.next_edit();
    }
}

impl Link for Hostile {
    fn inner(&mut self) -> Option<&mut dyn Link> {
        Some(&mut self.drive)
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.drive.send(bytes)
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
        let now = self.drive.now();
        let started = *self.started.get_or_insert(now);
        self.reads += 1;
        assert!(now - started < LONGEST_SESSION && self.reads < MOST_READS, "the session never ends");
        let mut sent = [0; 8 * MAX_FRAME];
        while self.ready.is_empty() {
            if self.babble > 0 && now < deadline {
                self.babble -= 1;
                self.drive.wait_until((now + Duration::from_millis(1)).min(deadline))?;
                self.ready.push(0x55);
                break;
            }
            let count = self.drive.receive(&mut sent, deadline)?;
            if count == 0 {
                return Ok(0);
            }
            sent[..count]
                .split_inclusive(|&byte| byte == frame::DELIMITER)
                .for_each(|frame| self.pass(frame));
        }
        let count = self.ready.len().min(buffer.len());
        buffer[..count].copy_from_slice(&self.ready[..count]);
        self.ready.drain(..count);
        Ok(count)
    }

    fn discard_input(&mut self) -> Result<(), LinkError> {
        self.ready.clear();
        self.drive.discard_input()
    }
}
