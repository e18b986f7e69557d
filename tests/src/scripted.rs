//! Runs in real time on a scripted clock: the drive is in this process, time passes only where the loop waits for it, and the
//! bench sleeps when the script says so. What is late is late in every run by the same, on any machine.

use std::fs;
use std::time::{Duration, Instant};

use lashloop_bench::atomic_file::WriteError;
use lashloop_bench::device::DeviceChoice;
use lashloop_bench::device::kinds::in_process::InProcessDrive;
use lashloop_bench::run::{self, Clock, DeviceUnderTest, Outcome, RunError, Step, StepObserver};
use lashloop_bench::scenario::{Override, Scenario};
use lashloop_bench::supervisor::Supervisor;
use lashloop_bench::timing::{ClockName, StepOutcome};
use lashloop_firmware::Laws;
use lashloop_link::{Link, LinkError};
use lashloop_protocol::message::EncoderSample;
use lashloop_protocol::wire::Payload;

use crate::workspace;

/// A run to be made.
#[derive(Default)]
pub struct Script<'a> {
    /// Path of the scenario in the workspace.
    pub scenario: &'a str,
    /// Added at the end of the scenario: its faults.
    pub faults: &'a str,
    /// Settings, as `--set` takes them.
    pub settings: &'a [&'a str],
    /// The bench sleeps from the first to the second time, in seconds since its first sample.
    pub sleeps: &'a [[f64; 2]],
    /// Decides whether the line loses these bytes of the bench.
    pub loses: Option<fn(&[u8]) -> bool>,
    /// Lets the run wait for the drive, without a deadline in real time.
    pub in_lockstep: bool,
}

/// A run that was made.
pub struct Made {
    /// Its outcome, or why it has none.
    pub outcome: Result<Outcome, RunError>,
    /// Its steps.
    pub steps: Vec<Step>,
}

impl Script<'_> {
    /// Makes the run.
    ///
    /// # Panics
    /// The scenario can't be read, or the drive not opened.
    #[must_use]
    pub fn run(&self) -> Made {
        let path = workspace().join(self.scenario);
        let text = fs::read_to_string(path).expect("a scenario") + "\n" + self.faults;
        let settings: Vec<_> = self.settings.iter().map(|it| Override::Set((*it).to_owned())).collect();
        let scenario = Scenario::from_str(self.scenario, &text, &settings).expect("a scenario");
        let supervisor = Supervisor::without_signals(None).expect("a supervisor");
        let choice = DeviceChoice::from(InProcessDrive::<Laws>::default());
        let (sleeps, loses) = (self.sleeps.to_vec(), self.loses);
        let sleeper = |link| -> Box<dyn Link> { Box::new(Sleeper { link, sleeps, loses, began: None }) };
        let clock = if self.in_lockstep { Clock::Lockstep } else { Clock::Scripted };
        let mut device = DeviceUnderTest::open(&scenario, &choice, ClockName::RealTime, &supervisor, sleeper)
            .expect("a drive in this process");
        let mut steps = Steps(Vec::new());
        let outcome = run::run(&scenario, &mut device, clock, &mut steps);
        Made { outcome, steps: steps.0 }
    }
}

impl Made {
    /// The outcome.
    ///
    /// # Panics
    /// There is none.
    #[must_use]
    pub fn outcome(&self) -> &Outcome {
        self.outcome.as_ref().expect("a run with an outcome")
    }

    /// The torque of each step, in N m.
    #[must_use]
    pub fn torque_nm(&self) -> Vec<f64> {
        self.steps.iter().map(|step| step.row.torque_nm).collect()
    }

    /// The steps with this outcome.
    #[must_use]
    pub fn with(&self, outcome: StepOutcome) -> Vec<usize> {
        (0..self.steps.len()).filter(|&step| self.steps[step].timing.outcome == outcome).collect()
    }
}

struct Steps(Vec<Step>);

impl StepObserver for Steps {
    fn step(&mut self, step: &Step) -> Result<(), WriteError> {
        self.0.push(step.clone());
        Ok(())
    }
}

/// A link whose waits end when the bench is awake.
struct Sleeper {
    link: Box<dyn Link>,
    sleeps: Vec<[f64; 2]>,
    loses: Option<fn(&[u8]) -> bool>,
    /// When the first sample was sent.
    began: Option<Instant>,
}

impl Sleeper {
    fn sleep(&mut self) -> Result<(), LinkError> {
        let now = self.link.now();
        let Some(began) = self.began else { return Ok(()) };
        for [from, until] in self.sleeps.clone() {
            let [from, until] = [from, until].map(|time_s| began + Duration::from_secs_f64(time_s));
            if from <= now && now < until {
                self.link.wait_until(until)?;
            }
        }
        Ok(())
    }
}

impl Link for Sleeper {
    fn inner(&mut self) -> Option<&mut dyn Link> {
        Some(self.link.as_mut())
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        if self.began.is_none() && bytes.len() == EncoderSample::LAYOUT.frame_len() {
            self.began = Some(self.link.now());
        }
        if self.loses.is_some_and(|loses| loses(bytes)) {
            return Ok(());
        }
        self.link.send(bytes)
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
        let count = self.link.receive(buffer, deadline)?;
        self.sleep()?;
        Ok(count)
    }

    fn discard_input(&mut self) -> Result<(), LinkError> {
        self.link.discard_input()
    }

    fn wait_until(&mut self, until: Instant) -> Result<(), LinkError> {
        self.link.wait_until(until)?;
        self.sleep()
    }
}
