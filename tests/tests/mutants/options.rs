//! A drive with pins and a boot loader, as the firmware of a board has them: it passes every check, and wrong answers about its
//! options fail.

use std::time::{Duration, Instant};

use lashloop_conformance::{CheckResult, CheckStatus};
use lashloop_firmware::drive::{Clock, Drive, PinHardware, PinReadings};
use lashloop_firmware::input_filter::FILTERS;
use lashloop_firmware::power_stage::StageMode;
use lashloop_link::{Link, LinkError};
use lashloop_protocol::enums::{Capabilities, Outcome, ParameterFlags, ParameterValue, State};
use lashloop_protocol::message::{Arm, CommandResult, EnterLoader, Reference, SetZero};
use lashloop_protocol::wire::Payload;
use lashloop_protocol::{Decoder, DriveMessage, Message};

use crate::laws::TestLaws;
use crate::{BENCH_MODE, OPTIONS, results};

const HARDWARE: PinHardware = PinHardware {
    largest_move_counts: 32_767,
    filters: &FILTERS,
    stage_modes: &[StageMode::Amplifier],
    longest_period_us: 65_535,
    measures_current: false,
    has_index: [false; 2],
};
/// Time between two looks of the drive at its pins and its watchdog.
const TICK: Duration = Duration::from_millis(1);

struct Now(Duration);

impl Clock for Now {
    fn now(&self) -> Duration {
        self.0
    }
}

/// A drive with both options and a virtual clock, whose messages are altered on the way.
struct Board {
    drive: Drive<TestLaws>,
    boot: Instant,
    clock: Now,
    alter: fn(&mut DriveMessage),
    decoder: Decoder,
    output: Vec<u8>,
}

impl Board {
    fn new(alter: fn(&mut DriveMessage)) -> Self {
        let drive = Drive::with_pins("board", HARDWARE).with_loader();
        let (clock, output) = (Now(Duration::ZERO), Vec::new());
        let mut board = Self { drive, boot: Instant::now(), clock, alter, decoder: Decoder::new(), output };
        board.look();
        board
    }

    fn look(&mut self) {
        self.drive.tick(self.clock.0);
        self.drive.sample(&PinReadings::default(), self.clock.0, &self.clock);
        self.collect();
    }

    fn collect(&mut self) {
        let bytes = self.drive.output().to_vec();
        self.drive.clear_output();
        let mut rest = &bytes[..];
        while let Some(message) = self.decoder.next::<DriveMessage>(&mut rest) {
            let mut message = message.expect("a good frame");
            (self.alter)(&mut message.message);
            self.output.extend_from_slice(&message.message.numbered_frame(message.number));
        }
    }

    fn pass(&mut self, until: Instant) {
        let until = until.saturating_duration_since(self.boot);
        self.clock.0 = (self.clock.0 + TICK).min(until).max(self.clock.0);
        self.look();
    }
}

impl Link for Board {
    fn inner(&mut self) -> Option<&mut dyn Link> {
        None
    }

    fn now(&mut self) -> Instant {
        self.boot + self.clock.0
    }

    fn wait_until(&mut self, until: Instant) -> Result<(), LinkError> {
        while self.now() < until {
            self.pass(until);
        }
        Ok(())
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        let mut rest = bytes;
        while !rest.is_empty() {
            let used = self.drive.receive(rest, &self.clock);
            rest = &rest[used..];
            self.collect();
        }
        Ok(())
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
        while self.output.is_empty() && self.now() < deadline {
            self.pass(deadline);
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

#[test]
fn a_board_with_pins_and_a_loader_passes_every_check() {
    let results = results(Board::new(|_| {}));
    // It neither stores nor captures.
    let is_lacked = |it: &CheckResult| {
        it.group == BENCH_MODE || it.group == OPTIONS && matches!(it.status, CheckStatus::Skipped { .. })
    };
    let broken = results.iter().filter(|it| it.status != CheckStatus::Passed && !is_lacked(it));
    let broken: Vec<_> = broken.collect();
    assert!(broken.is_empty(), "{broken:#?}");
}

/// Alters the result of the requests of a kind.
fn of(message: &mut DriveMessage, kind: u8, alter: impl Fn(&mut CommandResult)) {
    if let DriveMessage::CommandResult(it) = message
        && it.request == kind
    {
        alter(it);
    }
}

/// What a wrong drive does to one of its messages.
type Wrong = fn(&mut DriveMessage);

/// What is wrong, how, and the check that finds it.
const WRONG: [(&str, Wrong, &str); 10] = [
    (
        "bench mode without its capability",
        |it| {
            if let DriveMessage::Identity(it) = it {
                it.capabilities.remove(Capabilities::BENCH_MODE);
            }
        },
        "a drive has the parameters of bench mode if it announces it",
    ),
    (
        "a live duty",
        |it| match it {
            DriveMessage::ParameterDescription(it) if it.name.as_str() == "duty_max" => {
                it.flags.insert(ParameterFlags::LIVE);
            }
            _ => {}
        },
        "a drive has the parameters of bench mode if it announces it",
    ),
    (
        "pins by default",
        |it| match it {
            DriveMessage::ParameterDescription(it) if it.name.as_str() == "sample_source" => {
                it.default = ParameterValue::U32(1);
            }
            _ => {}
        },
        "a drive has the parameters of bench mode if it announces it",
    ),
    (
        "a Reference accepted",
        |it| of(it, Reference::LAYOUT.kind, |it| it.outcome = Outcome::Accepted),
        "a Reference is refused in every state of HIL mode",
    ),
    (
        "a refused Reference with a detail",
        |it| of(it, Reference::LAYOUT.kind, |it| it.detail = 1),
        "a Reference is refused in every state of HIL mode",
    ),
    (
        "an unknown outcome of Arm",
        |it| {
            of(it, Arm::LAYOUT.kind, |it| {
                if it.outcome == Outcome::Inconsistent {
                    it.outcome = Outcome::UnknownIndex;
                }
            });
        },
        "Arm in bench mode checks session, state and parameters before the pins",
    ),
    (
        "no parameter as the cause of a refusal",
        |it| {
            of(it, Arm::LAYOUT.kind, |it| {
                if it.outcome == Outcome::Inconsistent {
                    it.detail = 0;
                }
            });
        },
        "Arm in bench mode checks session, state and parameters before the pins",
    ),
    (
        "a boot loader for any host",
        |it| of(it, EnterLoader::LAYOUT.kind, |it| it.outcome = Outcome::Accepted),
        "EnterLoader is refused in another session and in every state but Idle",
    ),
    (
        "a boot loader for other states",
        |it| {
            of(it, EnterLoader::LAYOUT.kind, |it| {
                if it.state == State::Faulted {
                    it.outcome = Outcome::UnknownRequest;
                }
            });
        },
        "EnterLoader is refused in another session and in every state but Idle",
    ),
    (
        "a zero in every state",
        |it| of(it, SetZero::LAYOUT.kind, |it| it.outcome = Outcome::Accepted),
        "SetZero is refused in every state but Idle, and there with another source",
    ),
];

#[test]
fn wrong_answers_about_the_options_fail() {
    for (what, alter, check) in WRONG {
        let results = results(Board::new(alter));
        let failed = |it: &CheckResult| it.name == check && matches!(it.status, CheckStatus::Failed { .. });
        assert!(results.iter().any(failed), "{what}: {results:#?}");
    }
}
