//! The plants in Rust.

use std::error::Error;
use std::time::Instant;

use lashloop_plant::backlash_shaft::{BacklashShaft, ShaftParameters};
use lashloop_plant::hard_coulomb::HardCoulomb;
use lashloop_plant::smooth::Smooth;
use lashloop_plant::{Mechanics, Start, TwoMass};

use crate::Round;

/// A plant with the substeps of its scenarios.
pub struct Named {
    /// Name in scenarios.
    pub name: &'static str,
    /// Integration steps per millisecond.
    pub substeps: u32,
}

/// The plants to compare.
pub const PLANTS: [Named; 3] = [
    Named { name: "smooth", substeps: 4 },
    Named { name: "hard-coulomb", substeps: 4 },
    Named { name: "backlash-shaft", substeps: 16 },
];

impl Named {
    /// Integrates the plant for a number of control periods.
    pub fn round(&self, periods: u32) -> Result<Round, Box<dyn Error>> {
        let mechanics = Mechanics::paper();
        match self.name {
            "smooth" => run(&Smooth::new(mechanics, self.substeps)?, periods),
            "hard-coulomb" => run(&HardCoulomb::new(mechanics, 3.84, self.substeps)?, periods),
            _ => run(&BacklashShaft::new(mechanics, ShaftParameters::paper(), self.substeps)?, periods),
        }
    }
}

fn run<P: TwoMass>(plant: &P, periods: u32) -> Result<Round, Box<dyn Error>> {
    let mut state = plant.initial_state(Start::at_rest(0.0, 0.0));
    let started = Instant::now();
    for k in 0..periods {
        plant.step(&mut state, triangle_nm(k), 1e-3)?;
    }
    let ns = started.elapsed().as_nanos() as f64;
    let truth = plant.truth(&state);
    Ok(Round { ns, ends_rad: [truth.load_position_rad, truth.motor_position_rad] })
}

/// A triangle of +-2 N m every 2 s, exact in binary.
fn triangle_nm(k: u32) -> f64 {
    let t = k % 2000;
    f64::from(if t < 1000 { t } else { 2000 - t }) / 250.0 - 2.0
}
