//! An image on virtual silicon, at which a test acts at instants of device time.

use std::ops::ControlFlow;
use std::path::Path;
use std::sync::mpsc::{self, Receiver, Sender};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use lashloop_protocol::frame::DELIMITER;
use lashloop_silicon::drive_train::DriveTrain;
use lashloop_silicon::machine::{self, Ended};
use lashloop_silicon::pins::{Bridge, Pins};
use lashloop_silicon::surroundings::{Arrival, End, Surroundings};
use lashloop_silicon::symbols::Symbols;
use lashloop_silicon::wiring::{Encoder, Wiring};

use crate::turntable::{self, Speeds};

/// Counter of the motor encoder, TIM3.
pub const MOTOR_COUNTER: u64 = 0x4000_0424;
/// Status of the tick, TIM5, which its task clears first.
pub const TICK_STATUS: u64 = 0x4000_0c10;

/// The drive's image, as `cargo xtask image` builds it.
pub fn image() -> Symbols {
    image_of("lashloop-firmware")
}

/// The image of this name.
pub fn image_of(name: &str) -> Symbols {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../target").join(name).with_extension("elf");
    Symbols::read(&path).expect("`cargo xtask image` builds the image")
}

/// What the board has seen so far.
#[derive(Default)]
pub struct Log {
    /// Every change of the bridge.
    pub bridge: Vec<(Duration, Bridge)>,
    /// Arrivals at watched instructions.
    pub arrivals: Vec<Arrival>,
    /// Accesses to [`TICK_STATUS`].
    pub ticks: Vec<Duration>,
    /// Readings of [`MOTOR_COUNTER`], with the counts of both encoders at that instant.
    pub readings: Vec<(Duration, i64, i64)>,
}

/// An act of the test on the chip.
type Act = Box<dyn FnOnce(&mut Pins<'_>, &mut Site) + Send>;

enum Command {
    Act(Act),
    /// Runs the chip until a device time, or until it has sent a frame, and answers with the device time.
    Until(Duration, Option<Sender<Duration>>),
}

/// The surroundings: the drive train turns by itself, everything else is an act of the test.
pub struct Site {
    pub train: DriveTrain,
    pub log: Log,
    commands: Receiver<Command>,
    until: Duration,
    /// Takes the device time of a frame of the chip.
    on_frame: Option<Sender<Duration>>,
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

    fn watches_bridge(&self) -> bool {
        true
    }

    fn bridge_changed(&mut self, at: Duration, bridge: Bridge) {
        self.log.bridge.push((at, bridge));
    }

    fn arrived(&mut self, arrival: Arrival) {
        self.log.arrivals.push(arrival);
    }

    fn accessed(&mut self, at: Duration, register: u64) {
        match register {
            TICK_STATUS => self.log.ticks.push(at),
            MOTOR_COUNTER => {
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
    commands: Option<Sender<Command>>,
    machine: Option<JoinHandle<Ended<Site>>>,
    speeds: Speeds,
    now: Duration,
    resets_allowed: bool,
}

impl Bench {
    /// Boots an image, with encoders at these counts.
    pub fn boot(image: &Symbols, counts: (i64, i64)) -> Self {
        Self::boot_on(image, counts, Wiring::F405_BARE)
    }

    /// Boots an image on a board with this wiring.
    pub fn boot_on(image: &Symbols, counts: (i64, i64), wiring: Wiring) -> Self {
        let speeds = Speeds::default();
        let train = turntable::drive_train(&speeds, counts);
        let mut bench = Self::boot_with(image, train, wiring);
        bench.speeds = speeds;
        bench
    }

    /// Boots an image with this drive train, which takes no speeds.
    pub fn boot_with(image: &Symbols, train: DriveTrain, wiring: Wiring) -> Self {
        let (commands, receiver) = mpsc::channel();
        let site =
            Site { train, log: Log::default(), commands: receiver, until: Duration::ZERO, on_frame: None };
        let image = image.image().expect("an image");
        let machine = thread::spawn(move || machine::run(image, wiring, site).expect("the image runs"));
        Self {
            commands: Some(commands),
            machine: Some(machine),
            speeds: Speeds::default(),
            now: Duration::from_micros(50),
            resets_allowed: false,
        }
    }

    /// The chip may reset itself.
    pub fn allow_resets(&mut self) {
        self.resets_allowed = true;
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
        self.commands = None;
        let machine = self.machine.take().expect("one end");
        machine.join().expect("the machine didn't panic")
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
        let is_on = |bridge: &Bridge| bridge.driving().is_some();
        let before = changes.iter().rfind(|(at, _)| *at < instant).expect("a bridge");
        assert!(is_on(&before.1), "off since {:?}, before {instant:?}", before.0);
        let last_on = changes.iter().rposition(|(_, bridge)| is_on(bridge)).expect("it was on");
        changes.get(last_on + 1).map(|(at, _)| at.saturating_sub(instant))
    }

    fn command(&mut self, command: Command) {
        let sent = self.commands.as_ref().is_some_and(|commands| commands.send(command).is_ok());
        if !sent {
            self.ended_early();
        }
    }

    fn ended_early(&mut self) -> ! {
        let ended = self.machine.take().expect("one end").join();
        match ended {
            Ok(ended) => panic!("the run ended at {:?}: {}", ended.device_time, ended.violations),
            Err(_) => panic!("the machine panicked"),
        }
    }
}

impl Drop for Bench {
    fn drop(&mut self) {
        self.commands = None;
        let Some(machine) = self.machine.take() else { return };
        let ended = machine.join();
        if thread::panicking() {
            return;
        }
        let ended = ended.expect("the machine didn't panic");
        assert_eq!((ended.violations.to_string(), ended.end), (String::new(), Some(End::Done)));
        assert!(self.resets_allowed || ended.resets == 0, "{} resets", ended.resets);
    }
}
