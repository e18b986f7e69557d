//! An image on virtual silicon, at which a test acts at instants of device time.

use std::ops::ControlFlow;
use std::path::Path;
use std::sync::mpsc::{self, Receiver, Sender};
use std::thread;
use std::time::Duration;

use lashloop_protocol::frame::DELIMITER;
use lashloop_silicon::boards;
use lashloop_silicon::chip::CRYSTAL_HZ;
use lashloop_silicon::drive_train::DriveTrain;
use lashloop_silicon::machine::Ended;
use lashloop_silicon::pins::{Bridge, Pins};
use lashloop_silicon::surroundings::{Arrival, End, Surroundings};
use lashloop_silicon::symbols::Symbols;
use lashloop_silicon::wiring::Encoder;
use rigless::emulator::{Access, AccessKind};
use rigless::image::Image;

use crate::machine::Machine;
use crate::turntable::{self, Speeds};

/// Counter of the motor encoder, TIM3.
pub const MOTOR_COUNTER: u64 = 0x4000_0424;
/// Status of the tick, TIM5, which its task clears first and reads at its end.
pub const TICK_STATUS: u64 = 0x4000_0c10;
/// Option register of TIM5, which connects a channel to the low-speed oscillator.
pub const TICK_OPTION: u64 = 0x4000_0c50;
/// FLASH_CR of an STM32F4.
pub const FLASH_CONTROL: u64 = 0x4002_3c10;
/// Time from power-up to the first turn of the surroundings.
const FIRST_TURN: Duration = Duration::from_micros(50);

/// A board of each chip family.
pub const OF_EACH_FAMILY: [&str; 2] = [boards::DEFAULT, "nucleo-h743zi"];

/// The drive's image, as `cargo xtask image` builds it.
pub fn image() -> Symbols {
    image_of(boards::DEFAULT)
}

/// The image of the second board.
pub fn odrive_image() -> Symbols {
    image_of("odrive-v3")
}

/// The image of a board.
pub fn image_of(board: &str) -> Symbols {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../target");
    let path = folder.join(boards::image_of(board)).with_extension("elf");
    Symbols::read(&path).unwrap_or_else(|error| panic!("{error}; `cargo xtask image` builds it"))
}

/// What the board has seen so far.
#[derive(Default)]
pub struct Log {
    /// Every change of the bridge.
    pub bridge: Vec<(Duration, Bridge)>,
    /// Arrivals at watched instructions.
    pub arrivals: Vec<Arrival>,
    /// Starts of a step: writes to [`TICK_STATUS`].
    pub ticks: Vec<Duration>,
    /// Writes to [`TICK_OPTION`].
    pub lsi_selections: usize,
    /// Writes to [`FLASH_CONTROL`].
    pub flash_control: Vec<u32>,
    /// Readings of [`MOTOR_COUNTER`], with the counts of both encoders at that instant.
    pub readings: Vec<(Duration, i64, i64)>,
}

/// An act of the test on the chip.
type Act = Box<dyn FnOnce(&mut Pins<'_>, &mut Site) + Send>;

pub enum Command {
    Act(Act),
    /// Runs the chip until a device time, or until it has sent a frame, and answers with the device time.
    Until(Duration, Option<Sender<Duration>>),
}

/// The surroundings: the drive train turns by itself, everything else is an act of the test.
pub struct Site {
    pub train: DriveTrain,
    pub log: Log,
    /// `None` for a crystal that doesn't start.
    crystal_hz: Option<u64>,
    kept: Option<Image>,
    commands: Receiver<Command>,
    until: Duration,
    /// Takes the device time of a frame of the chip.
    on_frame: Option<Sender<Duration>>,
    /// Without what costs time: a core without memory protection, and no look at the bridge, as in the program.
    is_plain: bool,
}

impl Site {
    /// Discards the commands that the test has sent, and refuses further ones.
    pub fn close(&mut self) {
        self.commands = mpsc::channel().1;
    }
}

impl Surroundings for Site {
    fn turn(&mut self, chip: &mut Pins<'_>) -> ControlFlow<End, Duration> {
        let due = self.train.turn(chip).expect("the turntable turns");
        let mut has_frame = || chip.serial_line().received().contains(&DELIMITER);
        if self.on_frame.is_some() && (has_frame() || self.until <= chip.now()) {
            self.until = chip.now();
            let _ = self.on_frame.take().map(|answer| answer.send(chip.now()));
        }
        while self.until <= chip.now() {
            match self.commands.recv() {
                Ok(Command::Act(act)) => act(chip, self),
                Ok(Command::Until(instant, on_frame)) => {
                    (self.until, self.on_frame) = (instant, on_frame);
                }
                Err(_) => return ControlFlow::Break(End::Done),
            }
        }
        ControlFlow::Continue(due.min(self.until))
    }

    fn kept(&self) -> Option<Image> {
        self.kept.clone()
    }

    fn watches_bridge(&self) -> bool {
        !self.is_plain
    }

    fn crystal_starts(&self) -> bool {
        self.crystal_hz.is_some()
    }

    fn has_mpu(&self) -> bool {
        !self.is_plain
    }

    fn crystal_hz(&self) -> u64 {
        self.crystal_hz.unwrap_or(CRYSTAL_HZ)
    }

    fn bridge_changed(&mut self, at: Duration, bridge: Bridge) {
        self.log.bridge.push((at, bridge));
    }

    fn arrived(&mut self, arrival: Arrival) {
        self.log.arrivals.push(arrival);
    }

    fn accessed(&mut self, at: Duration, access: &Access) {
        match (access.address, access.kind) {
            (FLASH_CONTROL, AccessKind::Write) => self.log.flash_control.push(access.value as u32),
            (TICK_STATUS, AccessKind::Write) => self.log.ticks.push(at),
            (TICK_OPTION, AccessKind::Write) => self.log.lsi_selections += 1,
            (MOTOR_COUNTER, AccessKind::Read) => {
                self.log.readings.push((
                    at,
                    self.train.count(Encoder::Motor),
                    self.train.count(Encoder::Load),
                ));
            }
            _ => {}
        }
    }
}

/// The board. Dropping it requires that the chip has served every access.
pub struct Bench {
    machine: Option<Machine>,
    speeds: Speeds,
    now: Duration,
    resets_allowed: bool,
}

impl Bench {
    /// Powers up a chip with this image, with encoders at these counts.
    pub fn power_up(image: &Symbols, counts: (i64, i64)) -> Self {
        let speeds = Speeds::default();
        let mut bench = Self::new(image, turntable::drive_train(&speeds, counts), Some(CRYSTAL_HZ));
        bench.speeds = speeds;
        bench
    }

    /// As [`Self::power_up`], with this drive train, which takes no speeds.
    pub fn with_train(image: &Symbols, train: DriveTrain) -> Self {
        Self::new(image, train, Some(CRYSTAL_HZ))
    }

    /// As [`Self::with_train`], with a drive train that takes these speeds.
    pub fn with_turntable(image: &Symbols, train: DriveTrain, speeds: Speeds) -> Self {
        let mut bench = Self::with_train(image, train);
        bench.speeds = speeds;
        bench
    }

    /// As [`Self::with_turntable`], emulated as fast as in the program.
    pub fn plain(image: &Symbols, train: DriveTrain, speeds: Speeds) -> Self {
        let mut bench = Self::holding(image, train, Some(CRYSTAL_HZ), None, true);
        bench.speeds = speeds;
        bench
    }

    /// As [`Self::power_up`], with a crystal that doesn't start.
    pub fn without_crystal(image: &Symbols) -> Self {
        Self::new(image, turntable::drive_train(&Speeds::default(), (0, 0)), None)
    }

    /// As [`Self::power_up`], with another crystal.
    pub fn with_crystal(image: &Symbols, crystal_hz: u64) -> Self {
        Self::new(image, turntable::drive_train(&Speeds::default(), (0, 0)), Some(crystal_hz))
    }

    /// As [`Self::power_up`], with this in the flash memory besides the image.
    pub fn with_kept(image: &Symbols, at: u64, bytes: Vec<u8>) -> Self {
        let kept = Image::new(Path::new("kept"), bytes, Some(at)).expect("bytes at an address");
        let train = turntable::drive_train(&Speeds::default(), (0, 0));
        Self::holding(image, train, Some(CRYSTAL_HZ), Some(kept), false)
    }

    fn new(image: &Symbols, train: DriveTrain, crystal_hz: Option<u64>) -> Self {
        Self::holding(image, train, crystal_hz, None, false)
    }

    fn holding(
        image: &Symbols,
        train: DriveTrain,
        crystal_hz: Option<u64>,
        kept: Option<Image>,
        is_plain: bool,
    ) -> Self {
        let board = image.board().expect("an image").expect("the image names its board");
        let wiring = boards::open(&board).unwrap_or_else(|error| panic!("{error}"));
        let machine = Machine::power_up(image, wiring, |commands| Site {
            train,
            log: Log::default(),
            crystal_hz,
            kept,
            commands,
            until: Duration::ZERO,
            on_frame: None,
            is_plain,
        });
        Self { machine: Some(machine), speeds: Speeds::default(), now: FIRST_TURN, resets_allowed: false }
    }

    /// The chip may reset itself.
    pub fn allow_resets(&mut self) {
        self.resets_allowed = true;
    }

    /// Logs every arrival of the core at this instruction.
    pub fn watch(&mut self, address: u64) {
        self.act(move |chip, _| chip.watch(address).expect("a watch"));
    }

    /// Device time.
    pub fn now(&self) -> Duration {
        self.now
    }

    /// Runs the chip for a time.
    pub fn advance(&mut self, time: Duration) {
        self.advance_to(self.now + time);
    }

    /// Runs the chip until a device time, unless it is past.
    pub fn advance_to(&mut self, instant: Duration) {
        if instant > self.now {
            self.now = instant;
            self.command(Command::Until(instant, None));
        }
    }

    /// Runs the chip until it has sent a frame, at most until a device time later than now.
    pub fn advance_to_frame(&mut self, latest: Duration) {
        let (answer, answers) = mpsc::channel();
        self.command(Command::Until(latest, Some(answer)));
        self.now = answers.recv().unwrap_or_else(|_| self.ended_early());
    }

    /// Runs the chip until an access that it doesn't serve, or until a device time.
    pub fn end(mut self, latest: Duration) -> Ended<Site> {
        self.command(Command::Until(latest, None));
        self.machine.take().expect("one end").end()
    }

    /// Acts on the chip, now.
    pub fn act<T: Send + 'static>(
        &mut self,
        act: impl FnOnce(&mut Pins<'_>, &mut Site) -> T + Send + 'static,
    ) -> T {
        let (answer, answers) = mpsc::channel();
        self.command(Command::Act(Box::new(move |chip, site| {
            let _ = answer.send(act(chip, site));
        })));
        match answers.recv() {
            Ok(it) => it,
            Err(_) => self.ended_early(),
        }
    }

    /// Turns the encoders at these speeds in counts per second, from now on.
    pub fn turn(&mut self, motor: f64, load: f64) {
        let speeds = self.speeds.clone();
        self.act(move |_, _| speeds.set(motor, load));
    }

    /// The bridge, now.
    pub fn bridge(&mut self) -> Bridge {
        self.act(|chip, _| chip.bridge())
    }

    /// Device time from `instant` to the bridge off for good; `None` if it was on after `instant` until now.
    ///
    /// # Panics
    /// The bridge was off at `instant`.
    pub fn time_to_off(&mut self, instant: Duration) -> Option<Duration> {
        let changes = self.act(|_, site| site.log.bridge.clone());
        let before = changes.iter().rfind(|(at, _)| *at < instant).expect("a bridge");
        assert!(before.1.is_on(), "off since {:?}, before {instant:?}", before.0);
        let last_on = changes.iter().rposition(|(_, bridge)| bridge.is_on()).expect("it was on");
        changes.get(last_on + 1).map(|(at, _)| at.saturating_sub(instant))
    }

    fn command(&mut self, command: Command) {
        if !self.machine.as_ref().is_some_and(|machine| machine.send(command)) {
            self.ended_early();
        }
    }

    fn ended_early(&mut self) -> ! {
        let ended = self.machine.take().expect("one end").end();
        panic!("the run ended at {:?}: {}", ended.device_time, ended.violations)
    }
}

impl Drop for Bench {
    fn drop(&mut self) {
        if self.machine.is_none() || thread::panicking() {
            return;
        }
        // Ends early if the chip has not served every access.
        let resets = self.act(|chip, _| chip.resets());
        assert!(self.resets_allowed || resets == 0, "{resets} resets");
        self.machine.take().map(Machine::end);
    }
}
