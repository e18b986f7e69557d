//! The plants in Rust.

use std::error::Error;
use std::path::Path;
use std::time::Instant;

use lashloop_plant::backlash_shaft::{BacklashShaft, ShaftParameters};
use lashloop_plant::hard_coulomb::HardCoulomb;
use lashloop_plant::smooth::Smooth;
use lashloop_plant::{Mechanics, Plants, Positions, Release, Start, TwoMass};

use crate::round::Round;

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
    /// Integrates the plant for a number of control periods, called directly.
    pub fn round(&self, periods: u32) -> Result<Round, Box<dyn Error>> {
        let mechanics = Mechanics::paper();
        match self.name {
            "smooth" => run(&Smooth::new(mechanics, self.substeps)?, periods),
            "hard-coulomb" => run(&HardCoulomb::new(mechanics, 3.84, self.substeps)?, periods),
            _ => run(&BacklashShaft::new(mechanics, ShaftParameters::paper(), self.substeps)?, periods),
        }
    }

    /// The same as the bench does it: the registered model behind a `Box<dyn Plant>`.
    pub fn boxed_round(&self, periods: u32) -> Result<Round, Box<dyn Error>> {
        let plants = Plants::standard();
        let model = plants.get(self.name).ok_or("no such model")?;
        let values = model.defaults();
        let start = Start::at_rest(0.0, 0.0);
        let mut plant =
            model.release(&Release { values: &values, start, period_s: 1e-3, folder: Path::new("") })?;
        let started = Instant::now();
        for k in 0..periods {
            plant.step(triangle_nm(k), 1e-3)?;
        }
        let ns = started.elapsed().as_nanos() as f64;
        let Positions { motor_position_rad, load_position_rad } = plant.positions();
        Ok(Round { ns, ends_rad: [load_position_rad, motor_position_rad] })
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
