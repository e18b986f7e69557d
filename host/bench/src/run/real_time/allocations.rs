//! The loop's thread does not allocate: counted by an allocator, on every kind of link that buffers something. The counter
//! counts its own thread only, so drive, recorder and capture may allocate.
//!
//! The line is a terminal of the system, the time is scripted: it passes when the drive has nothing more to say.

use std::os::fd::OwnedFd;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use allocation_counter::AllocationInfo;
use lashloop_firmware::drive::{Clock, Drive};
use lashloop_link::terminal::Terminal;
use lashloop_link::{Link, LinkError, TimeBase};

use super::pacer::{Pacer, WallClock};
use super::*;
use crate::device::kinds::terminal::TerminalDrive;
use crate::device::{Device, DeviceChoice, DeviceError, DeviceKind, DriveHost, Opened};
use crate::fault::timeline::Timeline;
use crate::run::loop_state::LoopSettings;
use crate::run::run_loop::RunLoop;
use crate::run::simulator::Simulator;
use crate::run::step_sink::{Item, StepSink};
use crate::run::{End, RunError, setup};
use crate::scenario::{Override, Scenario};
use crate::supervisor::Supervisor;
use crate::timing::{ClockName, StepOutcome};
use lashloop_decode::capture::link::Captured;
use lashloop_decode::capture::{WhenFull, create};

/// Steps that the loop records; the last of 4,000 is recorded after it.
const STEPS: u64 = 3_999;

/// A scenario of every kind of plant.
const SMOOTH: &str = include_str!("../../../../../scenarios/smooth-after.toml");
const FRICTION: &str = include_str!("../../../../../scenarios/friction-after.toml");
const SHAFT: &str = include_str!("../../../../../scenarios/shaft-merzouki.toml");

const SETTINGS: [&str; 4] = [
    "run.duration_s=2",
    "run.control_period_us=500",
    "telemetry.every_steps=3",
    "controller.parameters.watchdog_us=50000000",
];

struct SinceBoot(Instant);

impl Clock for SinceBoot {
    fn now(&self) -> Duration {
        self.0.elapsed()
    }
}

/// What the drive has done so far.
#[derive(Debug, Default)]
struct Progress {
    /// Bytes whose answers are written.
    processed: AtomicU64,
    written: AtomicU64,
}

/// A drive at the far end of a terminal, until the line breaks.
fn drive(line: &OwnedFd, progress: &Progress) {
    let (mut drive, clock) = (Drive::new("a test"), SinceBoot(Instant::now()));
    let mut buffer = [0; 256];
    while let Ok(count) = rustix::io::read(line, &mut buffer) {
        let mut bytes = &buffer[..count];
        while !bytes.is_empty() {
            bytes = &bytes[drive.receive(bytes, &clock)..];
            progress.written.fetch_add(drive.output().len() as u64, Ordering::SeqCst);
            if rustix::io::write(line, drive.output()).is_err() {
                return;
            }
            drive.clear_output();
        }
        progress.processed.fetch_add(count as u64, Ordering::SeqCst);
    }
}

/// The drive on a terminal, by a clock that waits for it.
#[derive(Debug)]
struct Patient {
    terminal: TerminalDrive,
    progress: Arc<Progress>,
}

impl DeviceKind for Patient {
    fn name(&self) -> String {
        self.terminal.name()
    }

    fn open(&self, baud: u32, supervisor: &Supervisor) -> Result<Opened, DeviceError> {
        let Opened { link, .. } = self.terminal.open(baud, supervisor)?;
        let (progress, now) = (self.progress.clone(), Instant::now());
        let link = Box::new(PatientLink { link, progress, now, sent: 0, received: 0 });
        Ok(Opened { link, host: DriveHost::External })
    }
}

/// A link whose time passes when the drive has processed all bytes and all of its answers have arrived.
struct PatientLink {
    link: Box<dyn Link>,
    progress: Arc<Progress>,
    now: Instant,
    sent: u64,
    received: u64,
}

impl Link for PatientLink {
    fn inner(&mut self) -> Option<&mut dyn Link> {
        Some(self.link.as_mut())
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.sent += bytes.len() as u64;
        self.link.send(bytes)
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
        loop {
            let has_processed = self.progress.processed.load(Ordering::SeqCst) == self.sent;
            if has_processed && self.progress.written.load(Ordering::SeqCst) == self.received {
                self.now = self.now.max(deadline);
                return Ok(0);
            }
            let count = self.link.receive(buffer, Instant::now() + Duration::from_millis(1))?;
            if count > 0 {
                self.received += count as u64;
                return Ok(count);
            }
        }
    }

    fn discard_input(&mut self) -> Result<(), LinkError> {
        while self.receive(&mut [0; 256], self.now)? > 0 {}
        Ok(())
    }

    fn now(&mut self) -> Instant {
        self.now
    }

    fn wait_until(&mut self, until: Instant) -> Result<(), LinkError> {
        self.now = self.now.max(until);
        Ok(())
    }
}

/// Allocates a box per step if `wastes` is set.
struct Counting<'a> {
    ring: Ring<'a>,
    wastes: bool,
}

impl StepSink for Counting<'_> {
    fn take(&mut self, item: Item) -> Result<(), RunError> {
        if let (true, Item::Step(step)) = (self.wastes, &item) {
            drop(std::hint::black_box(Box::new(step.clone())));
        }
        self.ring.take(item)
    }

    fn stop_asked(&self) -> bool {
        self.ring.stop_asked()
    }
}

/// What a loop on a terminal did.
struct Counted {
    allocations: AllocationInfo,
    /// Steps made, and those of them that the drive answered: an idle loop allocates nothing either.
    made: u64,
    answered: u64,
}

/// Runs the loop on a terminal.
fn counted(
    text: &str,
    more: &[&str],
    wastes: bool,
    middleware: impl FnOnce(Box<dyn Link>) -> Box<dyn Link>,
) -> Counted {
    let settings: Vec<_> =
        SETTINGS.iter().chain(more).map(|setting| Override::Set((*setting).to_owned())).collect();
    let scenario = Scenario::from_str("of the test", text, &settings).expect("a scenario");
    let terminal = Terminal::open().expect("a terminal");
    let progress = Arc::new(Progress::default());
    let path = terminal.path.clone();
    let patient = Patient { terminal: TerminalDrive { path }, progress: progress.clone() };
    let choice = DeviceChoice::from(patient);
    let line = terminal.far_end.try_clone().expect("a handle");
    let twin = thread::spawn(move || drive(&line, &progress));
    let supervisor = Supervisor::start(std::env::current_exe().expect("a path")).expect("a supervisor");
    let mut device = Device::open_through(&choice, &scenario.link, &supervisor, middleware).expect("a drive");
    device.session.line.set_time_base(TimeBase::Scripted);
    let timeline = Timeline::new(&scenario, &device, None).expect("no faults");
    let drive_signals = setup::set_up(&mut device, &scenario, ClockName::RealTime)
        .expect("a drive that takes the scenario")
        .len();
    let watchdog = Some(setup::watchdog(&mut device).expect("a watchdog"));
    let torque_limit_nm = setup::torque_limit_nm(&mut device).expect("a torque limit");
    let settings = LoopSettings {
        is_timed: true,
        clock: ClockName::RealTime,
        watchdog,
        plant_signals: 0,
        drive_signals,
        torque_limit_nm,
        takes_torque: false,
    };
    device.session.start().expect("a drive that starts");

    let simulator = Simulator::new(&scenario).expect("a bench");
    let stop = AtomicBool::new(false);
    let (ring, mut steps) = Ring::new(&stop);
    let (mut made, mut answered) = (0, 0);
    let (mut allocations, mut end) = (AllocationInfo::default(), None);
    let work = || {
        let _ = obtain(&RealTime::default());
        let sink = Counting { ring, wastes };
        let mut control = RunLoop::new(&scenario, Some(simulator), timeline, settings, sink);
        allocations = allocation_counter::measure(|| {
            end = Some(close(&mut control, &scenario, &mut device, None));
        });
    };
    let drain_steps = || {
        while let Ok(item) = steps.pop() {
            let Item::Step(step) = item else { continue };
            made += 1;
            answered += u64::from(step.timing.outcome == StepOutcome::Answered);
        }
    };
    run_with_drain(work, drain_steps).expect("a thread");
    assert_eq!(end.expect("the loop has run").expect("a run"), End::Complete);
    device.session.stop().expect("a drive that stops");
    drop((device, terminal));
    // The near end is closed, so the drive's read fails.
    twin.join().expect("a drive");
    Counted { allocations, made, answered }
}

fn check_free_of_allocations(counted: &Counted) {
    let Counted { allocations, made, answered } = counted;
    assert_eq!((allocations.count_total, allocations.bytes_total), (0, 0), "{allocations:?}");
    assert_eq!((*made, *answered), (STEPS, STEPS));
}

#[test]
fn the_loop_does_not_allocate() {
    for text in [SMOOTH, FRICTION, SHAFT] {
        check_free_of_allocations(&counted(text, &[], false, |link| link));
    }
}

#[test]
fn a_wait_by_the_wall_clock_does_not_allocate() {
    let allocations = allocation_counter::measure(|| {
        let mut clock = WallClock::new();
        let pacer = Pacer::start(Instant::now(), Duration::from_millis(1), Duration::from_micros(200));
        for step in 0..10 {
            let _ = pacer.wait_for(pacer.due(step), &mut clock).expect("a clock");
        }
    });
    assert_eq!((allocations.count_total, allocations.bytes_total), (0, 0), "{allocations:?}");
}

#[test]
fn a_capture_and_a_modelled_uart_do_not_allocate() {
    let folder = tempfile::tempdir().expect("a folder");
    let (recorder, capture) = create(&folder.path().join("line.pcapng"), WhenFull::Fail).expect("a capture");
    let counted = counted(SMOOTH, &["link.modelled_baud=4000000"], false, |link| {
        Box::new(Captured::new(link, recorder))
    });
    check_free_of_allocations(&counted);
    assert!(capture.finish().expect("a capture") > STEPS);
}

#[test]
fn an_allocation_in_the_loop_is_counted() {
    let Counted { allocations, made, .. } = counted(SMOOTH, &[], true, |link| link);
    assert_eq!(made, STEPS);
    assert!(allocations.count_total >= made, "{allocations:?}");
}
