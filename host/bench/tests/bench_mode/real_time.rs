//! Real time: a drive with a clock of its own, on a scripted clock.

use std::time::{Duration, Instant};

use lashloop_bench::device::{DeviceError, DeviceKind, DriveHost, Opened};
use lashloop_bench::run::{Clock, End};
use lashloop_bench::supervisor::Supervisor;
use lashloop_bench::verdict::Verdict;
use lashloop_firmware::Laws;
use lashloop_firmware::drive::{self, Drive, PinHardware, PinReadings};
use lashloop_firmware::input_filter::FILTERS;
use lashloop_firmware::power_stage::StageMode;
use lashloop_link::in_process::Unread;
use lashloop_link::{Link, LinkError};

use crate::run::{Recorded, SMOOTH_AFTER, on_with, scenario};

const STEPS: u64 = 300;
/// 0.3 s without a motion; no expectation is met by a load that stands still.
const SETTINGS: [&str; 4] = [
    "run.duration_s=0.3",
    "expect=[]",
    "reference.position_rad=1.5707963267948966",
    "controller.parameters.watchdog_us=50000000",
];

/// Time of the drive: its ticks.
struct Ticks(Duration);

impl drive::Clock for Ticks {
    fn now(&self) -> Duration {
        self.0
    }
}

/// A drive at rest whose tick comes every so often by the clock of the bench, though its period is 1 ms.
#[derive(Debug)]
struct OwnClock(Duration);

impl DeviceKind for OwnClock {
    fn name(&self) -> String {
        "own clock".to_owned()
    }

    fn open(&self, _baud: u32, _supervisor: &Supervisor) -> Result<Opened, DeviceError> {
        let hardware = PinHardware {
            largest_move_counts: 32_767,
            filters: &FILTERS,
            stage_modes: &[StageMode::Amplifier],
            longest_period_us: 65_536,
            measures_current: false,
            has_index: [false; 2],
        };
        let now = Instant::now();
        let link = Ticking {
            drive: Drive::with_pins("a test", hardware),
            clock: Ticks(Duration::ZERO),
            tick: self.0,
            next: now + self.0,
            now,
            sent: Unread::default(),
        };
        Ok(Opened { link: Box::new(link), host: DriveHost::External })
    }
}

/// The drive and the time of the bench, which passes while the bench waits.
struct Ticking {
    drive: Drive<Laws>,
    clock: Ticks,
    tick: Duration,
    next: Instant,
    now: Instant,
    sent: Unread,
}

impl Ticking {
    /// Lets time pass to the next tick, `until` at most.
    fn pass(&mut self, until: Instant) {
        if self.next > until {
            return self.now = self.now.max(until);
        }
        self.now = self.next;
        self.next += self.tick;
        self.clock.0 += self.drive.period();
        self.drive.sample(&PinReadings::default(), self.clock.0, &self.clock);
        self.sent.take(&mut self.drive);
    }
}

impl Link for Ticking {
    fn inner(&mut self) -> Option<&mut dyn Link> {
        None
    }

    fn now(&mut self) -> Instant {
        self.now
    }

    fn wait_until(&mut self, until: Instant) -> Result<(), LinkError> {
        while self.now < until {
            self.pass(until);
        }
        Ok(())
    }

    fn send(&mut self, mut bytes: &[u8]) -> Result<(), LinkError> {
        while !bytes.is_empty() {
            bytes = &bytes[self.drive.receive(bytes, &self.clock)..];
            self.sent.take(&mut self.drive);
        }
        Ok(())
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
        while self.sent.is_empty() && self.now < deadline {
            self.pass(deadline);
        }
        Ok(self.sent.read(buffer))
    }

    fn discard_input(&mut self) -> Result<(), LinkError> {
        self.sent.clear();
        Ok(())
    }
}

fn run_with(tick: Duration) -> Recorded {
    on_with(&scenario(SMOOTH_AFTER, &SETTINGS), &OwnClock(tick).into(), Clock::Scripted).expect("a run")
}

/// The crystals of bench and drive differ; an internal oscillator is several percent off.
#[test]
fn every_step_of_a_drive_with_another_clock_is_recorded() {
    for tick_us in [950, 1_000, 1_060] {
        let Recorded { outcome, steps } = run_with(Duration::from_micros(tick_us));
        assert_eq!(
            (&outcome.end, outcome.judgement.verdict),
            (&End::Complete, Verdict::Pass),
            "{tick_us} us"
        );
        assert_eq!((outcome.steps, outcome.link.lost), (STEPS, 0), "{tick_us} us");
        let times = steps.iter().map(|step| step.row.time_s);
        assert!(times.enumerate().all(|(step, time_s)| (time_s - 1e-3 * step as f64).abs() < 1e-9));
    }
}

#[test]
fn a_drive_that_stops_reporting_leaves_lost_steps() {
    // Of 0.3 s and a tenth more, a drive with a tick of 2 ms makes half of the steps.
    let outcome = run_with(Duration::from_millis(2)).outcome;
    assert_eq!((&outcome.end, outcome.judgement.verdict), (&End::Complete, Verdict::Invalid));
    assert_eq!(outcome.steps, STEPS, "the record is as long as the run");
    assert!(outcome.timing.unanswered > 50, "{} steps are lost", outcome.timing.unanswered);
}
