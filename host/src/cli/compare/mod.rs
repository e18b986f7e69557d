//! `lashloop compare`: what the loop costs beside what it can't do without.
//!
//! The other side is the least that could do the job: a thread that sleeps until the next period, and a ping-pong of the
//! same bytes over a pseudo-terminal. In real time that has a deadline, as the loop has; what it takes without one is
//! shown beside it. Both sides take turns within one command, round by round, and ask the system for the
//! same; medians over the rounds are compared, because machines are noisy.

mod goals;
mod sleep_baseline;

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::Args;
use lashloop_bench::atomic_file::WriteError;
use lashloop_bench::device::kinds::native::NativeTwin;
use lashloop_bench::device::{Device, DeviceError};
use lashloop_bench::run::DeviceUnderTest;
use lashloop_bench::run::real_time::{PERIOD_MARGIN, RealTime};
use lashloop_bench::run::{self, Clock, Step, StepObserver};
use lashloop_bench::scenario::{Override, Scenario};
use lashloop_bench::supervisor::{Process, Program, Supervisor};
use lashloop_bench::timing::TimingReport;
use lashloop_bench::verdict::Exit;
use rustix::io::Errno;
use rustix::thread::{CpuSet, sched_getaffinity, sched_setaffinity};
use rustix::time::Timespec;

use super::demo::SCENARIOS;
use super::error::CliError;
use super::ping_pong::NearEnd;
use super::start_supervisor;
use goals::{Goals, median};

/// Control period of everything here that is paced; that of the scenarios.
const PERIOD: Duration = Duration::from_millis(1);
/// How long an answer is waited for in such a period, by both sides.
const REPLY_LIMIT: Timespec =
    Timespec { tv_sec: 0, tv_nsec: (PERIOD.as_nanos() - PERIOD.as_nanos() / PERIOD_MARGIN as u128) as i64 };
/// Steps at the start of a round that are not looked at.
const WARM_UP: u32 = 100;

/// Measure the loop against the bare minimum: a sleeping thread, and a ping-pong of the same bytes.
///
/// In lockstep the round trips a second, in real time at 1 kHz how late a step begins and how long its round trip
/// takes. Every figure has a goal; ends with 1 if one is missed. On a busy machine the ratios say more than the times.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Rounds of each side
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=1000))]
    rounds: u32,

    /// Control steps or round trips in a round of lockstep
    #[arg(long, default_value_t = 20_000, value_parser = clap::value_parser!(u32).range(100..=1_000_000))]
    steps: u32,

    /// Length of a round in real time
    #[arg(long, default_value_t = 2, value_name = "SECONDS", value_parser = clap::value_parser!(u32).range(1..=3600))]
    seconds: u32,

    /// In real time: look at the clock without pause for so long before each step, on both sides
    #[arg(long, default_value_t = 0, value_name = "US", value_parser = clap::value_parser!(u32).range(..=900))]
    spin_us: u32,

    /// Keep all four on this core, the loop and the drive, the bare thread and its far end: where the system puts two
    /// processes that talk to each other decides more about a round trip than anything they do
    #[arg(long, value_name = "NUMBER")]
    core: Option<usize>,

    /// In real time: run both sides under SCHED_FIFO with this priority
    #[arg(long, value_name = "PRIORITY", value_parser = clap::value_parser!(u8).range(1..=99))]
    fifo: Option<u8>,
}

impl Arguments {
    pub(crate) fn run(self) -> Result<Exit, CliError> {
        let anywhere = sched_getaffinity(None).map_err(placing_failed)?;
        let mut here = anywhere;
        if let Some(core) = self.core {
            here = CpuSet::new();
            here.set(core.min(CpuSet::MAX_CPU - 1));
        }
        // Whoever is started from here on stays where this thread is.
        let stay = |cores: &CpuSet| sched_setaffinity(None, cores).map_err(placing_failed);
        stay(&here)?;
        let supervisor = start_supervisor()?;
        let mut device = Device::open(&NativeTwin.into(), 0, &supervisor)?.into();
        let (far_end, path) = far_end(&supervisor)?;
        let mut line = NearEnd::open(&path).map_err(ping_pong_failed)?;
        let mut goals = Goals::default();
        self.lockstep(&mut device, &mut line, &mut goals)?;
        // In real time the loop has a thread of its own, and this one has to be out of its way.
        stay(&anywhere)?;
        self.real_time(&mut device, &mut line, &mut goals)?;
        drop(far_end);
        say!("{goals}");
        Ok(if goals.all_met() { Exit::Pass } else { Exit::Fail })
    }

    fn lockstep(
        &self,
        device: &mut DeviceUnderTest,
        line: &mut NearEnd,
        goals: &mut Goals,
    ) -> Result<(), CliError> {
        let scenario = scenario(f64::from(self.steps) * PERIOD.as_secs_f64())?;
        let (mut bare, mut loops) = (Vec::new(), Vec::new());
        for _ in 0..self.rounds {
            let started = Instant::now();
            for _ in 0..self.steps {
                line.round_trip().map_err(ping_pong_failed)?;
            }
            bare.push(f64::from(self.steps) / started.elapsed().as_secs_f64());
            let outcome = run::run(&scenario, device, Clock::Lockstep, &mut Nobody)?;
            loops.push(outcome.steps as f64 / outcome.wall_s);
        }
        goals.at_least("lockstep: round trips, 1/s", 0.8, median(bare), median(loops));
        Ok(())
    }

    fn real_time(
        &self,
        device: &mut DeviceUnderTest,
        line: &mut NearEnd,
        goals: &mut Goals,
    ) -> Result<(), CliError> {
        let spin = Duration::from_micros(self.spin_us.into());
        let options = RealTime { spin, core: self.core, fifo_priority: self.fifo, ..RealTime::default() };
        let scenario = scenario(self.seconds.into())?;
        let steps = scenario.run.steps();
        let (mut sleeps, mut blocking, mut trips, mut loops) =
            (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for _ in 0..self.rounds {
            sleeps.push(sleep_baseline::paced(steps, &options, || Ok(None)).map_err(sleep_failed)?);
            let trip = || line.round_trip().map(Some);
            blocking.push(sleep_baseline::paced(steps, &options, trip).map_err(ping_pong_failed)?);
            let trip = || line.round_trip_with_a_deadline(REPLY_LIMIT).map(Some);
            trips.push(sleep_baseline::paced(steps, &options, trip).map_err(ping_pong_failed)?);
            let outcome = run::run(&scenario, device, Clock::RealTime(options), &mut Nobody)?;
            loops.push(outcome.timing);
        }
        let of = |reports: &[TimingReport], value: fn(&TimingReport) -> Option<f64>| {
            median(reports.iter().map(|report| value(report).unwrap_or(f64::NAN)).collect())
        };
        let p50 = |report: &TimingReport| report.lateness_us.map(|lateness| lateness.p50);
        let p99 = |report: &TimingReport| report.lateness_us.map(|lateness| lateness.p99);
        let trip = |report: &TimingReport| report.round_trip_us.map(|trip| trip.p50);
        if self.spin_us > 0 {
            goals.below("1 kHz, spinning: lateness p99, us", 10.0, of(&sleeps, p99), of(&loops, p99));
        } else {
            goals.at_most("1 kHz: lateness p50, us", 1.2, of(&sleeps, p50), of(&loops, p50));
            goals.at_most("1 kHz: lateness p99, us", 1.2, of(&sleeps, p99), of(&loops, p99));
        }
        goals.at_most("1 kHz: round trip p50, us", 1.3, of(&trips, trip), of(&loops, trip));
        for refusal in sleeps
            .iter()
            .chain(&blocking)
            .chain(&trips)
            .chain(&loops)
            .flat_map(|report| &report.refused)
            .collect::<BTreeSet<_>>()
        {
            say!("not granted: {refusal}");
        }
        goals.note("1 kHz: round trip p50, bare: no deadline, us", of(&blocking, trip), of(&loops, trip));
        // A sleeper that does nothing is woken sooner on a busy machine than one that works.
        goals.note("1 kHz: lateness p99, bare: ping-pong, us", of(&trips, p99), of(&loops, p99));
        goals.note(
            "1 kHz: late steps in all rounds",
            (late(&sleeps) + late(&blocking) + late(&trips)) as f64,
            late(&loops) as f64,
        );
        Ok(())
    }
}

fn late(reports: &[TimingReport]) -> u64 {
    reports.iter().map(TimingReport::late).sum()
}

/// One of the paper's, for as long as asked. Its watchdog bears a machine that stops everything for a while.
fn scenario(duration_s: f64) -> Result<Scenario, CliError> {
    let (name, text) = SCENARIOS[0];
    let settings = [
        format!("run.duration_s={duration_s}"),
        format!("run.warm_up_steps={WARM_UP}"),
        "controller.parameters.watchdog_us=10000000".to_owned(),
    ];
    Ok(Scenario::from_str(name, text, &settings.map(Override::Set))?)
}

/// The other end of the ping-pong: a process, as the drive is one.
fn far_end(supervisor: &Supervisor) -> Result<(Process, PathBuf), CliError> {
    let program = Program {
        name: "ping-pong",
        program: supervisor.bench(),
        arguments: vec!["ping-pong".into()],
        core: None,
    };
    let spawn_failed = |source| DeviceError::Spawn { name: program.name, source };
    let process = supervisor.spawn(&program).map_err(spawn_failed)?;
    let path = process
        .next_line(Instant::now() + Duration::from_secs(5))
        .ok_or_else(|| DeviceError::NotUp { name: process.name(), stderr: process.stderr_head() })?;
    Ok((process, path.into()))
}

fn ping_pong_failed(source: std::io::Error) -> CliError {
    CliError::System { what: "play ping-pong", source }
}

fn sleep_failed(source: std::io::Error) -> CliError {
    CliError::System { what: "keep time", source }
}

fn placing_failed(error: Errno) -> CliError {
    CliError::System { what: "choose a core", source: error.into() }
}

struct Nobody;

impl StepObserver for Nobody {
    fn step(&mut self, _step: &Step) -> Result<(), WriteError> {
        Ok(())
    }
}
