//! Steps of the plants compared with the same steps in C: `cargo run --release --manifest-path benchmarks/plant/Cargo.toml`.
//!
//! Both sides integrate the same 20 s under the same torque, in turn, round after round. Each figure is the median of the
//! rounds, so that other load affects both sides. The comparison fails if the trajectories disagree. The C compiler is `cc` with
//! `-O3 -march=native`; Rust is built as in a release, for any x86-64, unless `RUSTFLAGS` changes that. Rust is measured twice:
//! called directly, and boxed, as the bench calls a registered model: one virtual call a period.
//!
//! With the argument `loop`, whole runs and campaigns compared with a plain loop in C, see `closed_loop`.

mod c_side;
mod closed_loop;
mod round;
mod rust_side;

use std::error::Error;

use c_side::CSide;
use round::median;

/// Number of rounds.
const ROUNDS: usize = 21;
/// Control periods of 1 ms in a round.
const PERIODS: u32 = 20_000;

fn main() -> Result<(), Box<dyn Error>> {
    println!("load: {}", std::fs::read_to_string("/proc/loadavg").unwrap_or_default().trim());
    match std::env::args().nth(1).as_deref() {
        None => plants(),
        Some("loop") => closed_loop::compare(),
        Some(other) => Err(format!("{other}: expected no argument, or loop").into()),
    }
}

fn plants() -> Result<(), Box<dyn Error>> {
    let mut c = CSide::build("plants", c_side::FOR_THIS_MACHINE)?;
    println!(
        "rust: built {}",
        if cfg!(target_feature = "avx2") { "for this machine" } else { "for any x86-64" }
    );
    println!("c:    {}", c.description());
    println!(
        "| plant | substeps | rust, ns per substep | boxed, ns per substep | c, ns per substep | c / boxed |"
    );
    println!("|---|---|---|---|---|---|");
    for plant in rust_side::PLANTS {
        let (mut rust_ns, mut boxed_ns, mut c_ns) = (Vec::new(), Vec::new(), Vec::new());
        for _ in 0..ROUNDS {
            let (rust, boxed) = (plant.round(PERIODS)?, plant.boxed_round(PERIODS)?);
            let c = c.round(plant.name, PERIODS)?;
            if rust.ends_rad != boxed.ends_rad {
                return Err(format!("{}: {:?} rad behind a box", plant.name, boxed.ends_rad).into());
            }
            for (have, want) in rust.ends_rad.iter().zip(c.ends_rad) {
                if (have - want).abs() > 1e-6 * want.abs().max(1.0) {
                    return Err(format!("{}: Rust ends at {have} rad, C at {want} rad", plant.name).into());
                }
            }
            rust_ns.push(rust.ns);
            boxed_ns.push(boxed.ns);
            c_ns.push(c.ns);
        }
        let per_substep = |rounds| median(rounds) / f64::from(PERIODS * plant.substeps);
        let [rust, boxed, c] = [rust_ns, boxed_ns, c_ns].map(per_substep);
        println!(
            "| {} | {} | {rust:.1} | {boxed:.1} | {c:.1} | {:.2} |",
            plant.name,
            plant.substeps,
            c / boxed
        );
    }
    Ok(())
}
