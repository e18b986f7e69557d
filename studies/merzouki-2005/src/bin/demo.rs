//! The demo as a program of its own, which builds in a fraction of the command line's time: the drive runs in this process.

#![forbid(unsafe_code)]

use std::error::Error;
use std::fs;
use std::path::Path;
use std::process::ExitCode;

use lashloop::{Bench, Verdict, run};
use merzouki_2005::demo;
use merzouki_2005::figures::Run;

/// Folder of the figure.
const OUT: &str = "out";

fn main() -> Result<ExitCode, Box<dyn Error>> {
    let (scenarios, device) = (demo::scenarios()?, Bench::new().device("inproc")?);
    println!("{}", demo::head());
    let (mut runs, mut worst) = (Vec::new(), Verdict::Pass);
    for scenario in &scenarios {
        let outcome = run(scenario, &device)?;
        let run = Run { trace: outcome.columns().clone(), metrics: outcome.details().metrics.clone() };
        println!("{}", demo::row(runs.len(), &run, outcome.verdict()));
        runs.push(run);
        worst = worst.max(outcome.verdict());
    }
    fs::create_dir_all(OUT)?;
    let path = Path::new(OUT).join(demo::FIGURE_FILE);
    fs::write(&path, demo::figure(runs, &scenarios).to_svg())?;
    println!("figure: {}", path.display());
    Ok(lashloop_bench::verdict::Exit::from(worst).into())
}
