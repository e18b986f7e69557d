//! `lashloop benchmark`: the cost of the loop against a baseline.
//!
//! The baseline is the minimum for the task: a thread that sleeps until the next period, and a ping-pong of the same bytes
//! over a pseudo-terminal. In real time the ping-pong has the loop's deadline; its time without a deadline is printed as
//! well. Loop and baseline alternate round by round within one command and request the same privileges. Medians over the
//! rounds are compared, because machines are noisy.
//!
//! In the same rounds the loop runs with a record, and with a live page whose reader takes nothing; the loop alone is the
//! baseline of both.

mod goals;
mod sleep_baseline;
mod watched;

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::Args;
use lashloop::Bench;
use lashloop_bench::device::kinds::native::NativeTwin;
use lashloop_bench::device::{Device, DeviceError};
use lashloop_bench::run::real_time::{PERIOD_MARGIN, RealTime};
use lashloop_bench::run::{self, Clock, DeviceUnderTest, Outcome, StepObserver};
use lashloop_bench::scenario::{Override, Scenario};
use lashloop_bench::supervisor::{Process, Program, Supervisor};
use lashloop_bench::timing::TimingReport;
use lashloop_bench::verdict::Exit;
use rustix::thread::{CpuSet, sched_getaffinity, sched_setaffinity};
use rustix::time::Timespec;

use super::clock_options::core_refusal;
use super::error::{CliError, system};
use super::output::outln;
use super::ping_pong::NearEnd;
use super::supervision::start_supervisor;
use goals::Target::{AtLeast, AtMost, Below, None as NoTarget};
use goals::{Goals, median};
use merzouki_2005::scenarios::SCENARIOS;
use sleep_baseline::{PERIOD, WARM_UP};

/// Answer timeout within a period, for loop and baseline.
const REPLY_LIMIT: Timespec =
    Timespec { tv_sec: 0, tv_nsec: (PERIOD.as_nanos() - PERIOD.as_nanos() / PERIOD_MARGIN as u128) as i64 };

/// Measure the loop against a baseline: a sleeping thread and a ping-pong
///
/// Measures round trips per second in lockstep, and lateness and round-trip time of a step in real time at 1 kHz; the loop
/// alone, with a record, and with a live page whose reader takes nothing. Exit
/// code 1 if a measurement misses its goal. On a busy machine rely on the ratios, not on the times.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Rounds of loop and baseline
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=1000))]
    rounds: u32,

    /// Control steps or round trips per lockstep round
    #[arg(long, default_value_t = 20_000, value_parser = clap::value_parser!(u32).range(100..=1_000_000))]
    steps: u32,

    /// Duration of a real-time round, in s
    #[arg(long, default_value_t = 2, value_name = "SECONDS", value_parser = clap::value_parser!(u32).range(1..=3600))]
    seconds: u32,

    /// Real time: busy-wait before each step, in us, for loop and baseline
    #[arg(long, default_value_t = 0, value_name = "US", value_parser = clap::value_parser!(u32).range(..=900))]
    spin_us: u32,

    /// Core of loop, drive, baseline thread and its far end. The placement of two communicating processes dominates
    /// their round-trip time
    #[arg(long, value_name = "NUMBER")]
    core: Option<usize>,

    /// Real time: SCHED_FIFO priority of loop and baseline
    #[arg(long, value_name = "PRIORITY", value_parser = clap::value_parser!(u8).range(1..=99))]
    fifo: Option<u8>,
}

impl Arguments {
    pub(crate) fn run(self, _: &Bench) -> Result<Exit, CliError> {
        if let Some(refusal) = self.core.and_then(core_refusal) {
            return Err(refusal);
        }
        let anywhere = sched_getaffinity(None).map_err(system(PLACE))?;
        let mut here = anywhere;
        if let Some(core) = self.core {
            here = CpuSet::new();
            here.set(core);
        }
        // Processes started from here on inherit the core.
        let stay = |cores: &CpuSet| sched_setaffinity(None, cores).map_err(system(PLACE));
        stay(&here)?;
        let supervisor = start_supervisor()?;
        let mut device = Device::open(&NativeTwin.into(), 0, &supervisor)?.into();
        let (far_end, path) = far_end(&supervisor)?;
        let mut line = NearEnd::open(&path).map_err(system(PING_PONG))?;
        let mut goals = Goals::default();
        self.lockstep(&mut device, &mut line, &mut goals)?;
        // In real time the loop has its own thread, and this one must not compete for its core.
        stay(&anywhere)?;
        self.real_time(&mut device, &mut line, &mut goals)?;
        drop(far_end);
        outln!("{goals}");
        Ok(if goals.all_met() { Exit::Pass } else { Exit::Fail })
    }

    fn lockstep(
        &self,
        device: &mut DeviceUnderTest,
        line: &mut NearEnd,
        goals: &mut Goals,
    ) -> Result<(), CliError> {
        let scenario = scenario(f64::from(self.steps) * PERIOD.as_secs_f64())?;
        let [mut baseline, mut loops, mut recorded, mut live] = [const { Vec::new() }; 4];
        for _ in 0..self.rounds {
            let started = Instant::now();
            for _ in 0..self.steps {
                line.round_trip().map_err(system(PING_PONG))?;
            }
            baseline.push(f64::from(self.steps) / started.elapsed().as_secs_f64());
            let rate = |outcome: Outcome| outcome.steps as f64 / outcome.wall_s;
            loops.push(rate(run::run(&scenario, device, Clock::Lockstep, &mut NoOutput)?));
            recorded.push(rate(watched::recorded(&scenario, device, Clock::Lockstep)?));
            live.push(rate(watched::live(&scenario, device, Clock::Lockstep)?));
        }
        let alone = median(loops);
        goals.push("lockstep: round trips, 1/s", AtLeast(0.85), median(baseline), alone);
        // In lockstep one thread does all: the record takes time of the loop, and of no step.
        goals.push("lockstep, recording: round trips, 1/s", NoTarget, alone, median(recorded));
        goals.push("lockstep, live page: round trips, 1/s", NoTarget, alone, median(live));
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
        let [mut sleeps, mut blocking, mut trips, mut loops, mut recorded, mut live] =
            [const { Vec::new() }; 6];
        for _ in 0..self.rounds {
            let slept = sleep_baseline::paced(steps, &options, || Ok(None));
            sleeps.push(slept.map_err(system("sleep until the next period"))?);
            let trip = || line.round_trip().map(Some);
            blocking.push(sleep_baseline::paced(steps, &options, trip).map_err(system(PING_PONG))?);
            let trip = || line.round_trip_with_a_deadline(REPLY_LIMIT).map(Some);
            trips.push(sleep_baseline::paced(steps, &options, trip).map_err(system(PING_PONG))?);
            let clock = Clock::RealTime(options);
            loops.push(run::run(&scenario, device, clock, &mut NoOutput)?.timing);
            recorded.push(watched::recorded(&scenario, device, clock)?.timing);
            live.push(watched::live(&scenario, device, clock)?.timing);
        }
        let of = |reports: &[TimingReport], value: fn(&TimingReport) -> Option<f64>| {
            median(reports.iter().map(|report| value(report).unwrap_or(f64::NAN)).collect())
        };
        let p50 = |report: &TimingReport| report.lateness_us.map(|lateness| lateness.p50);
        let p99 = |report: &TimingReport| report.lateness_us.map(|lateness| lateness.p99);
        let trip = |report: &TimingReport| report.round_trip_us.map(|trip| trip.p50);
        if self.spin_us > 0 {
            goals.push("1 kHz, spinning: lateness p99, us", Below(10.0), of(&sleeps, p99), of(&loops, p99));
        } else {
            goals.push("1 kHz: lateness p50, us", AtMost(1.2), of(&sleeps, p50), of(&loops, p50));
            goals.push("1 kHz: lateness p99, us", AtMost(1.2), of(&sleeps, p99), of(&loops, p99));
        }
        goals.push("1 kHz: round trip p50, us", AtMost(1.3), of(&trips, trip), of(&loops, trip));
        goals.push("1 kHz, recording: lateness p50, us", AtMost(1.2), of(&loops, p50), of(&recorded, p50));
        goals.push(
            "1 kHz, recording: round trip p50, us",
            AtMost(1.2),
            of(&loops, trip),
            of(&recorded, trip),
        );
        goals.push("1 kHz, live page: lateness p50, us", AtMost(1.2), of(&loops, p50), of(&live, p50));
        goals.push("1 kHz, live page: round trip p50, us", AtMost(1.2), of(&loops, trip), of(&live, trip));
        let reports = [&sleeps, &blocking, &trips, &loops, &recorded, &live].into_iter().flatten();
        for refusal in reports.flat_map(|report| &report.refused).collect::<BTreeSet<_>>() {
            outln!("not granted: {refusal}");
        }
        goals.push("1 kHz: round trip p50, no deadline, us", NoTarget, of(&blocking, trip), of(&loops, trip));
        // On a busy machine the system wakes an idle sleeper earlier than a busy one.
        goals.push("1 kHz: lateness p99, ping-pong, us", NoTarget, of(&trips, p99), of(&loops, p99));
        goals.push(
            "1 kHz: late steps in all rounds",
            NoTarget,
            (late(&sleeps) + late(&blocking) + late(&trips)) as f64,
            late(&loops) as f64,
        );
        Ok(())
    }
}

fn late(reports: &[TimingReport]) -> u64 {
    reports.iter().map(TimingReport::late).sum()
}

/// One of the paper's scenarios with this duration. Its long watchdog tolerates a machine that stalls.
fn scenario(duration_s: f64) -> Result<Scenario, CliError> {
    let (name, text) = SCENARIOS[0];
    let settings = [
        format!("run.duration_s={duration_s}"),
        format!("run.warm_up_steps={WARM_UP}"),
        "controller.parameters.watchdog_us=10000000".to_owned(),
    ];
    Ok(Scenario::from_str(name, text, &settings.map(Override::Set))?)
}

/// The far end of the ping-pong: a process, as the drive is.
fn far_end(supervisor: &Supervisor) -> Result<(Process, PathBuf), CliError> {
    let program = Program {
        name: "ping-pong",
        program: supervisor.bench.clone().into(),
        arguments: vec!["ping-pong".into()],
        core: None,
    };
    let spawn_failed = |source| DeviceError::Spawn { name: program.name, source };
    let process = supervisor.spawn(&program).map_err(spawn_failed)?;
    let path = process
        .next_line(Instant::now() + Duration::from_secs(5))
        .ok_or_else(|| DeviceError::NotUp { name: process.name, stderr: process.stderr() })?;
    Ok((process, path.into()))
}

const PING_PONG: &str = "exchange ping-pong";
const PLACE: &str = "choose a core";

struct NoOutput;

impl StepObserver for NoOutput {}
