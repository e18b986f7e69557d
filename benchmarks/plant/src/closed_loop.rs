//! Whole runs and campaigns compared with a plain loop in C: `-- loop` behind the command.
//!
//! All sides simulate the same 25 s at 1 kHz: the backlash shaft, its encoders and the law `pd`. A run also carries each sample
//! and torque as frames, with telemetry, metrics, the torque digest and the verdict; a campaign also writes its table. Rounds
//! alternate. Processor time is compared, which other programs change little; the rate of a campaign is in wall-clock time.

use std::error::Error;
use std::num::NonZeroUsize;
use std::thread::available_parallelism;
use std::time::{Duration, Instant};

use lashloop_bench::device::DeviceChoice;
use lashloop_bench::device::kinds::in_process::InProcessDrive;
use lashloop_bench::run::{self, Clock, DeviceUnderTest};
use lashloop_bench::scenario::plant::standard;
use lashloop_bench::supervisor::Supervisor;
use lashloop_bench::timing::ClockName;
use lashloop_campaign::engine::ShardRun;
use lashloop_campaign::facts::{Facts, Program};
use lashloop_campaign::run::run_case;
use lashloop_campaign::shard::Shard;
use lashloop_campaign::shard_file::Start;
use lashloop_campaign::workers::Stop;
use lashloop_campaign::{Campaign, Selection, Source};
use lashloop_firmware::Laws;
use lashloop_plant::metrics::{Measured, Metric};
use rustix::time::{ClockId, clock_gettime};

use crate::c_side::{CSide, PLAIN};
use crate::round::median;

const ROUNDS: usize = 9;
/// Runs of one side in a round.
const RUNS: u32 = 16;
const PERIODS: u32 = 25_000;
/// Largest distance of C's last position from the mean of the last second of a run, in rad: the load is at rest.
const TOLERANCE_RAD: f64 = 1e-6;

/// A side of the comparison.
struct Side {
    name: String,
    /// Processor time of a run, round by round.
    run_ms: Vec<f64>,
    /// Runs per second and core, round by round.
    rate_hz: Vec<f64>,
}

impl Side {
    fn new(name: &str) -> Self {
        Self { name: name.to_owned(), run_ms: Vec::new(), rate_hz: Vec::new() }
    }

    fn push(&mut self, processor: Duration, wall: Duration, cores: NonZeroUsize) {
        let runs = f64::from(RUNS);
        self.run_ms.push(1e3 * processor.as_secs_f64() / runs);
        self.rate_hz.push(runs / wall.as_secs_f64() / cores.get() as f64);
    }
}

pub fn compare() -> Result<(), Box<dyn Error>> {
    let mut c = CSide::build("loop", PLAIN)?;
    println!("c: {}", c.description());
    let campaign = campaign()?;
    let device: DeviceChoice = InProcessDrive::<Laws>::default().into();
    let supervisor = Supervisor::without_signals(None)?;
    let all_cores = available_parallelism()?;
    let mut in_c = Side::new("plain loop in C");
    let mut single = Side::new("single runs");
    let mut one = Side::new("campaign, 1 job");
    let mut all = Side::new(&format!("campaign, {all_cores} jobs"));
    for _ in 0..ROUNDS {
        let (wall, mut processor_ns) = (Instant::now(), 0.0);
        let mut last_rad = f64::NAN;
        for _ in 0..RUNS {
            let round = c.round("loop", PERIODS)?;
            processor_ns += round.ns;
            [last_rad, _] = round.ends_rad;
        }
        in_c.push(Duration::from_nanos(processor_ns as u64), wall.elapsed(), NonZeroUsize::MIN);

        let (wall, processor) = (Instant::now(), processor_time()?);
        for number in 0..RUNS {
            let scenario = campaign.scenario(&campaign.case(number.into())?)?;
            let lockstep = ClockName::Lockstep;
            let mut opened = DeviceUnderTest::open(&scenario, &device, lockstep, &supervisor, |link| link)?;
            let outcome = run::run(&scenario, &mut opened, Clock::Lockstep, &mut &Stop::new(&supervisor))?;
            let at_rest = outcome.metrics.get(Metric::StaticError);
            match at_rest {
                Measured::Value(rad) if (rad - last_rad).abs() < TOLERANCE_RAD => {}
                _ => return Err(format!("a run ends at {at_rest:?}, C at {last_rad} rad").into()),
            }
        }
        single.push(processor_time()? - processor, wall.elapsed(), NonZeroUsize::MIN);

        for (side, jobs) in [(&mut one, NonZeroUsize::MIN), (&mut all, all_cores)] {
            let folder = tempfile::tempdir()?;
            let facts = facts(&campaign);
            let (shard, start) = (Shard::WHOLE, Start::New);
            let shard =
                ShardRun { campaign: &campaign, facts: &facts, folder: folder.path(), shard, start, jobs };
            let (wall, processor) = (Instant::now(), processor_time()?);
            shard.run(&supervisor, |case, stop| run_case(&campaign, &device, case, stop), |_| {})?;
            side.push(processor_time()? - processor, wall.elapsed(), jobs);
        }
    }
    println!("| 25 s at 1 kHz | processor time per run, ms | of C's speed | runs per second and core |");
    println!("|---|---|---|---|");
    let in_c_ms = in_c.run_ms.clone();
    for side in [in_c, single, one, all] {
        let ratio = median(in_c_ms.iter().zip(&side.run_ms).map(|(c, it)| c / it).collect());
        let (run_ms, rate_hz) = (median(side.run_ms), median(side.rate_hz));
        println!("| {} | {run_ms:.1} | {:.0} % | {rate_hz:.1} |", side.name, 100.0 * ratio);
    }
    Ok(())
}

fn processor_time() -> Result<Duration, Box<dyn Error>> {
    Ok(clock_gettime(ClockId::ProcessCPUTime).try_into()?)
}

/// The scenario of the loop in C, once for each seed.
fn campaign() -> Result<Campaign, Box<dyn Error>> {
    let seeds: Vec<_> = (1..=RUNS).map(|seed| seed.to_string()).collect();
    let file = format!(
        "title = \"The loop\"\nscenario = \"shaft-pd.toml\"\n[[part]]\nname = \"runs\"\nmethod = \"list\"\n\
         [[part.axis]]\nkey = \"run.seed\"\nvalues = [{}]\n",
        seeds.join(", ")
    );
    let scenario = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/shaft-pd.toml");
    let source = |name: &str, text| Source { path: format!("scenarios/{name}"), text };
    let sources =
        vec![source("loop.toml", file), source("shaft-pd.toml", std::fs::read_to_string(scenario)?)];
    Ok(Campaign::from_sources(sources, Selection::default(), &standard())?)
}

fn facts(campaign: &Campaign) -> Facts {
    let text = |text: &str| text.to_owned();
    let program = Program {
        lashloop: text("benchmark"),
        sha256: text("none"),
        device: text("inproc"),
        drive: text("none"),
    };
    Facts::new(campaign, program, 1)
}
