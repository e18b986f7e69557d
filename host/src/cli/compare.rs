//! `lashloop compare`: how much of a bare line's speed the loop keeps.

use std::path::Path;
use std::time::{Duration, Instant};

use clap::Args;
use lashloop::device::{Device, DeviceChoice, DeviceError};
use lashloop::record::RecordError;
use lashloop::run::{self, Clock, Step, Watcher};
use lashloop::scenario::{Override, Scenario};
use lashloop::supervisor::Program;
use lashloop::verdict::Exit;

use super::demo::SCENARIOS;
use super::error::CliError;
use super::start_supervisor;

/// Measure the loop against a bare pseudo-terminal ping-pong of the same bytes.
///
/// Both run as two processes, in turn, several rounds in one command; medians are compared, because machines are noisy.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Rounds of each side
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=1000))]
    rounds: u32,

    /// Control steps or round trips in a round
    #[arg(long, default_value_t = 20_000, value_parser = clap::value_parser!(u32).range(100..=1_000_000))]
    steps: u32,
}

impl Arguments {
    pub(crate) fn run(self) -> Result<Exit, CliError> {
        let supervisor = start_supervisor()?;
        let (name, text) = SCENARIOS[0];
        let duration = Override::Set(format!("run.duration_s={}", f64::from(self.steps) * 1e-3));
        let scenario = Scenario::from_str(name, text, &[duration])?;
        let mut device = Device::open(&DeviceChoice::Native, 0, &supervisor)?;
        let far_end = Program {
            name: "ping-pong",
            program: supervisor.bench(),
            arguments: vec!["ping-pong".into()],
            core: None,
        };
        let spawn_failed = |source| DeviceError::Spawn { name: far_end.name, source };
        let far_end = supervisor.spawn(&far_end).map_err(spawn_failed)?;
        let path = far_end
            .next_line(Instant::now() + Duration::from_secs(5))
            .ok_or_else(|| DeviceError::NotUp { name: far_end.name(), said: far_end.said() })?;

        let (mut bare, mut loops) = (Vec::new(), Vec::new());
        for _ in 0..self.rounds {
            let time = super::ping_pong::play(Path::new(&path), self.steps)
                .map_err(|source| CliError::System { what: "play ping-pong", source })?;
            bare.push(f64::from(self.steps) / time.as_secs_f64());
            let outcome = run::run(&scenario, &mut device, Clock::Lockstep, &mut Nobody)?;
            loops.push(outcome.steps as f64 / outcome.wall_s);
        }
        let (bare, looped) = (median(&mut bare), median(&mut loops));
        say!("{:<44} {:>10}", format!("median of {} rounds of {}", self.rounds, self.steps), "1/s");
        say!("{:<44} {bare:>10.0}", "bare blocking pty ping-pong, same bytes");
        say!("{:<44} {looped:>10.0}", "the loop: plant, frames, drive, record");
        say!("{:<44} {:>10.2}", "ratio", looped / bare);
        Ok(Exit::Pass)
    }
}

struct Nobody;

impl Watcher for Nobody {
    fn step(&mut self, _step: &Step) -> Result<(), RecordError> {
        Ok(())
    }
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
