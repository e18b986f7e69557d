//! The drive: what a host talks to.
//!
//! A state machine without I/O. Its owner hands it the bytes that arrived and a clock, takes the bytes it wants sent,
//! calls [`Drive::tick`] every millisecond or so, and gives [`Drive::torque_nm`] to the motor if there is one.
//!
//! ```text
//!            Hello (same version)       Arm           Start
//!     Boot ───────────────────▶ Idle ─────▶ Armed ─────────▶ Running
//!      ▲ Reset (from anywhere)  ▲ ▲  ◀─────  │ ◀──────────────  │
//!                               │ │   Stop; Hello of another   │
//!                    ClearFault │      session                 │ watchdog, encoder jump,
//!                               │                              ▼ non-finite number
//!                             Faulted ◀──────────────────── EmergencyStop (from anywhere)
//! ```
//!
//! Only `Running` gives torque. In HIL the encoder sample is the tick of the control loop: no timer is in its path, so
//! the torque depends on the frames alone.

mod clock;
mod control_loop;
mod output;
pub mod parameters;
mod safety;
mod sample;
mod session;

use core::time::Duration;

use lashloop_protocol::enums::{FaultCode, LogLevel, State, Version};
use lashloop_protocol::message::{FaultReport, TorqueAnswer};
use lashloop_protocol::{Counters, Decoder, Frame};

pub use clock::{Clock, ManualClock};
use control_loop::ControlLoop;
use output::Output;
use parameters::Parameters;
use safety::Safety;

/// Version of this firmware.
pub const FIRMWARE_VERSION: Version = Version {
    major: parse(env!("CARGO_PKG_VERSION_MAJOR")),
    minor: parse(env!("CARGO_PKG_VERSION_MINOR")),
    patch: parse(env!("CARGO_PKG_VERSION_PATCH")),
};

const fn parse(number: &str) -> u8 {
    match u8::from_str_radix(number, 10) {
        Ok(number) => number,
        Err(_) => panic!("a part of the version does not fit into a byte"),
    }
}

/// First 32 bits of the commit this firmware was built from; 0 if unknown.
pub const BUILD_ID: u32 = match u32::from_str_radix(env!("LASHLOOP_BUILD_ID"), 16) {
    Ok(id) => id,
    Err(_) => 0,
};

/// The state machine.
pub struct Drive {
    board: &'static str,
    decoder: Decoder,
    output: Output,
    parameters: Parameters,
    safety: Safety,
    session: Option<u32>,
    control: Option<ControlLoop>,
    last_answer: Option<TorqueAnswer>,
    /// Bytes the hardware lost before they got here, since the start of the run.
    overruns: u32,
    counters_at_start: Counters,
}

impl Drive {
    /// A drive that has just been powered: disarmed, with default parameters. `board` is the name of the board, of at
    /// most 16 bytes.
    #[must_use]
    pub fn new(board: &'static str) -> Self {
        Self {
            board,
            decoder: Decoder::new(),
            output: Output::default(),
            parameters: Parameters::default(),
            safety: Safety::new(),
            session: None,
            control: None,
            last_answer: None,
            overruns: 0,
            counters_at_start: Counters::default(),
        }
    }

    /// Takes bytes from the line, at most to the end of one frame, and returns how many it took.
    ///
    /// Call it again with the rest after sending [`Drive::output`] and clearing it. Zero for a non-empty input means
    /// that the output has to be sent first.
    pub fn receive(&mut self, bytes: &[u8], clock: &impl Clock) -> usize {
        if !self.output.has_room_for_an_answer() {
            return 0;
        }
        let mut rest = bytes;
        // A damaged frame is nothing but a missing one: the decoder counts it, and the host notices the silence.
        if let Some(Ok(message)) = self.decoder.next(&mut rest) {
            self.handle(&message, clock);
        }
        bytes.len() - rest.len()
    }

    /// Lets time pass: the watchdog. `now` is device time since boot.
    pub fn tick(&mut self, now: Duration) {
        if let Err(fault) = self.safety.check_watchdog(now) {
            self.latch(fault);
        }
    }

    /// When [`Drive::tick`] is next needed, in device time; `None` while nothing can trip.
    #[must_use]
    pub fn next_tick(&self) -> Option<Duration> {
        self.safety.watchdog_deadline()
    }

    /// The bytes to be sent.
    #[must_use]
    pub fn output(&self) -> &[u8] {
        self.output.bytes()
    }

    /// Forgets the bytes, once they are sent.
    pub fn clear_output(&mut self) {
        self.output.clear();
    }

    /// The torque the motor is to give now, in N m. Zero unless running.
    #[must_use]
    pub fn torque_nm(&self) -> f32 {
        self.safety.torque_nm()
    }

    /// Where the drive is in its life.
    #[must_use]
    pub fn state(&self) -> State {
        self.safety.state()
    }

    /// What the decoder has seen.
    #[must_use]
    pub fn counters(&self) -> &Counters {
        self.decoder.counters()
    }

    /// Sends the pieces as one line of text to the host, if there is room: a text never displaces an answer.
    ///
    /// Pieces and no format: formatting would cost the image more flash than the control laws.
    pub fn log(&mut self, level: LogLevel, pieces: &[&str]) {
        self.output.log(level, pieces);
    }

    /// Tells of `count` more bytes that the hardware lost (overrun, framing). The host hears of them at the stop.
    pub fn note_overruns(&mut self, count: u32) {
        self.overruns = self.overruns.saturating_add(count);
    }

    /// Torque to zero first, then the report.
    fn latch(&mut self, fault: FaultReport) {
        self.disarm_with(fault);
        self.output.send(fault);
    }

    fn disarm_with(&mut self, fault: FaultReport) {
        self.safety.latch(fault);
        self.control = None;
    }
}

/// The last thing a dying firmware says, as a whole frame: for panic and fault handlers, which have no drive to ask.
#[must_use]
pub fn fault_frame(code: FaultCode, detail: u32) -> Frame {
    Frame::of(&FaultReport { code, sequence: 0, value: 0.0, limit: 0.0, detail })
}
