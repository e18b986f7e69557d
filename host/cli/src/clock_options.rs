//! The options of a run's clock.

use std::time::Duration;

use clap::{Args, ValueEnum};
use lashloop_bench::device::DeviceChoice;
use lashloop_bench::run::Clock;
use lashloop_bench::run::real_time::{RealTime, usable_cores};
use lashloop_bench::scenario::{RunMode, Scenario};
use lashloop_bench::timing::ClockName;

use super::error::CliError;

#[derive(Args)]
pub(crate) struct ClockOptions {
    /// Clock of the run: in `lockstep` plant and drive wait for each other, and a run is repeatable bit for bit; in
    /// `real-time` the plant follows wall-clock time, and a torque can miss its deadline
    #[arg(long, value_enum, default_value_t = Choice::Lockstep, value_name = "CLOCK")]
    clock: Choice,

    /// Real time: busy-wait before each step, in us; occupies a core
    #[arg(long, value_name = "US", value_parser = clap::value_parser!(u32).range(..=100_000))]
    spin_us: Option<u32>,

    /// Real time: SCHED_FIFO priority of the loop
    #[arg(long, value_name = "PRIORITY", value_parser = clap::value_parser!(u8).range(1..=99))]
    fifo: Option<u8>,

    /// Real time: lock the bench's memory, so that it is never paged out
    #[arg(long)]
    lock_memory: bool,

    /// Real time: core of the loop, from 0
    #[arg(long, value_name = "NUMBER")]
    core: Option<usize>,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Choice {
    Lockstep,
    RealTime,
}

impl ClockOptions {
    /// The error of a core that doesn't exist, or that this process is kept from.
    fn core_refusal(&self) -> Option<CliError> {
        core_refusal(self.core?)
    }

    /// Lockstep, unless the drive is on hardware and has a time of its own.
    pub(crate) fn for_drive(&self, scenario: &Scenario, choice: &DeviceChoice) -> Result<Clock, CliError> {
        let clock = self.clock()?;
        let name = ClockName::Lockstep;
        let is_real = clock == Clock::Lockstep
            && scenario.run.mode == RunMode::Bench
            && !choice.for_run(scenario, name)?.keeps_bench_clock(name);
        Ok(if is_real { Clock::RealTime(RealTime::default()) } else { clock })
    }

    pub(crate) fn clock(&self) -> Result<Clock, CliError> {
        let options = [
            ("--spin-us", self.spin_us.is_some()),
            ("--fifo", self.fifo.is_some()),
            ("--lock-memory", self.lock_memory),
            ("--core", self.core.is_some()),
        ];
        if let (Choice::RealTime, Some(refusal)) = (self.clock, self.core_refusal()) {
            return Err(refusal);
        }
        match (self.clock, options.iter().find(|(_, given)| *given)) {
            (Choice::Lockstep, Some((option, _))) => Err(CliError::RealTimeAlone { option }),
            (Choice::Lockstep, None) => Ok(Clock::Lockstep),
            (Choice::RealTime, _) => Ok(Clock::RealTime(RealTime {
                spin: Duration::from_micros(self.spin_us.unwrap_or_default().into()),
                fifo_priority: self.fifo,
                lock_memory: self.lock_memory,
                core: self.core,
            })),
        }
    }
}

/// The error of a core that doesn't exist, or that this process is kept from.
pub(crate) fn core_refusal(core: usize) -> Option<CliError> {
    let usable = usable_cores();
    (!usable.is_empty() && !usable.contains(&core)).then_some(CliError::Core { core, usable })
}
