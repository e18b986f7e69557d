//! Real time: a drive with a clock of its own, at the far end of a socket.

use std::io::{ErrorKind, Read, Write};
use std::os::unix::net::UnixStream;
use std::thread;
use std::time::{Duration, Instant};

use lashloop_bench::device::{DeviceError, DeviceKind, DriveHost, Opened};
use lashloop_bench::run::real_time::RealTime;
use lashloop_bench::run::{Clock, End};
use lashloop_bench::supervisor::Supervisor;
use lashloop_bench::verdict::Verdict;
use lashloop_firmware::Laws;
use lashloop_firmware::drive::{self, Drive, PinHardware, PinReadings};
use lashloop_link::socket::Socket;

use crate::run::{Recorded, SMOOTH_AFTER, on_with, scenario};

const STEPS: u64 = 300;
/// 0.3 s without a motion; no expectation is met by a load that stands still.
const SETTINGS: [&str; 4] = [
    "run.duration_s=0.3",
    "expect=[]",
    "reference.position_rad=1.5707963267948966",
    "controller.parameters.watchdog_us=50000000",
];

/// Time of the drive: its ticks. A busy machine makes none of them late.
struct Ticks(Duration);

impl drive::Clock for Ticks {
    fn now(&self) -> Duration {
        self.0
    }
}

/// A drive whose tick comes every so often in wall-clock time, though its period is 1 ms.
#[derive(Debug)]
struct OwnClock(Duration);

impl DeviceKind for OwnClock {
    fn name(&self) -> String {
        "own clock".to_owned()
    }

    fn open(&self, _baud: u32, _supervisor: &Supervisor) -> Result<Opened, DeviceError> {
        let (near, far) = UnixStream::pair().expect("a pair of sockets");
        let tick = self.0;
        thread::spawn(move || serve(far, tick));
        let link = Socket::new(near).expect("a link");
        Ok(Opened { link: Box::new(link), host: DriveHost::External })
    }
}

/// Serves a drive at rest until the bench disconnects.
fn serve(mut line: UnixStream, tick: Duration) {
    let hardware = PinHardware {
        largest_move_counts: 32_767,
        largest_counts_per_s: 41_000_000,
        longest_period_us: 65_536,
    };
    let (mut drive, mut clock) = (Drive::<Laws>::with_pins("a test", hardware), Ticks(Duration::ZERO));
    let mut next = Instant::now();
    let mut buffer = [0; 256];
    loop {
        let wait = next.saturating_duration_since(Instant::now());
        if wait.is_zero() {
            clock.0 += drive.period();
            drive.sample(&PinReadings::default(), clock.0, &clock);
            next += tick;
        } else {
            line.set_read_timeout(Some(wait)).expect("a timeout");
            match line.read(&mut buffer) {
                Ok(0) => return,
                Ok(count) => {
                    let mut bytes = &buffer[..count];
                    while !bytes.is_empty() {
                        bytes = &bytes[drive.receive(bytes, &clock)..];
                        if line.write_all(drive.output()).is_err() {
                            return;
                        }
                        drive.clear_output();
                    }
                }
                Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {}
                Err(_) => return,
            }
        }
        if line.write_all(drive.output()).is_err() {
            return;
        }
        drive.clear_output();
    }
}

fn run_with(tick: Duration) -> Recorded {
    let clock = Clock::RealTime(RealTime::default());
    on_with(&scenario(SMOOTH_AFTER, &SETTINGS), &OwnClock(tick).into(), clock).expect("a run")
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
