//! The options that say what paces a run.

use std::time::Duration;

use clap::{Args, ValueEnum};
use lashloop_bench::run::Clock;
use lashloop_bench::run::real_time::RealTime;

use super::error::CliError;

#[derive(Args)]
pub(crate) struct Pace {
    /// What paces the run: in `lockstep` plant and drive wait for each other and a run is the same bit for bit; in
    /// `real-time` the plant keeps to the clock on the wall, and a torque that is late is late
    #[arg(long, value_enum, default_value_t = Choice::Lockstep, value_name = "CLOCK")]
    clock: Choice,

    /// In real time: look at the clock without pause for so long before each step; a core is busy then
    #[arg(long, value_name = "US", value_parser = clap::value_parser!(u32).range(..=100_000))]
    spin_us: Option<u32>,

    /// In real time: run the loop under SCHED_FIFO with this priority
    #[arg(long, value_name = "PRIORITY", value_parser = clap::value_parser!(u8).range(1..=99))]
    fifo: Option<u8>,

    /// In real time: keep the bench's memory from being paged out
    #[arg(long)]
    lock_memory: bool,

    /// In real time: keep the loop on this core
    #[arg(long, value_name = "NUMBER")]
    core: Option<usize>,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Choice {
    Lockstep,
    RealTime,
}

impl Pace {
    pub(crate) fn clock(&self) -> Result<Clock, CliError> {
        let options = [
            ("--spin-us", self.spin_us.is_some()),
            ("--fifo", self.fifo.is_some()),
            ("--lock-memory", self.lock_memory),
            ("--core", self.core.is_some()),
        ];
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
