//! Counts damaged frames that the decoder accepts:
//! `cargo run --release -p tests --example undetected_errors -- --frames 100000000 --seed 1`.

use std::env;
use std::process::ExitCode;
use std::time::Instant;

#[path = "../tests/robustness/undetected_errors.rs"]
mod undetected_errors;

const USAGE: &str = "usage: undetected_errors [--frames N] [--seed N]";

fn main() -> ExitCode {
    let (mut frames, mut seed) = (100_000_000, 1);
    let mut arguments = env::args().skip(1);
    while let Some(name) = arguments.next() {
        let value = arguments.next().and_then(|value| value.parse().ok());
        match (name.as_str(), value) {
            ("--frames", Some(value)) => frames = value,
            ("--seed", Some(value)) => seed = value,
            _ => {
                eprintln!("{USAGE}");
                return ExitCode::from(2);
            }
        }
    }
    let started = Instant::now();
    let tallies = undetected_errors::run(frames, seed);
    print!("{}", undetected_errors::Table(&tallies));
    let wrong: u64 = tallies.iter().map(|(_, tally)| tally.wrong).sum();
    println!("{wrong} wrong messages, seed {seed}, {:.0} s", started.elapsed().as_secs_f64());
    ExitCode::SUCCESS
}
