//! Twists at the first sample, where a fit has put the motor into the wrong dent of the cogging.
//!
//! A motor at rest stands in one of the dents that the cogging makes. No small step of the twist leads from one to the
//! next, so a fit stays in that from which it began.

use std::f64::consts::TAU;

use crate::noise::Noise;
use crate::parameters::Parameter;
use crate::problem::{Point, Problem, residual};
use crate::replay::OwnParameters;

/// Twists that are tried on either side, and how many of them are in a dent.
const TRIED: i32 = 16;
const IN_DENT: f64 = 8.0;
/// Logarithms of the motor's stiction over its Coulomb friction that are tried, and the gain that makes one of them the better.
const STICTIONS: u32 = 12;
const STICTION_STEP: f64 = 0.05;
const GAIN: f64 = 0.01;
/// Ratio of the two steps.
const FINER: f64 = 16.0;

impl Problem<'_> {
    /// The point with another stiction of the motor, or else with other twists, under which the motions are nearer to their
    /// records; `None` if they are those of the point.
    pub(crate) fn other_rests(&self, point: &Point) -> Option<Point> {
        let noise = self.noise(point, &self.predict(point)?);
        let cost = |point: &Point| Some(self.cost(point, &self.predict(point)?, &noise));
        let mut least = cost(point)?;
        let mut next = None;
        // A motor that the model lets go at once gets no nearer by a small step of the stiction.
        for tried in 0..=STICTIONS {
            let mut other = point.clone();
            other.vector.set(Parameter::MotorExcess, STICTION_STEP * f64::from(tried));
            if let Some(cost) = cost(&other).filter(|cost| *cost < (1.0 - GAIN) * least) {
                (least, next) = (cost, Some(other));
            }
        }
        let stuck = next.as_ref().unwrap_or(point);
        self.other_dents(stuck).or(next)
    }

    /// The point with the twists under which each motion is the nearest to its record; `None` if they are those of the
    /// point.
    fn other_dents(&self, point: &Point) -> Option<Point> {
        let noise = self.noise(point, &self.predict(point)?);
        let step_rad = TAU / f64::from(point.vector.cogging_per_turn) / IN_DENT;
        let mut next = point.clone();
        for &index in &self.used {
            let present = point.own[index];
            let mut least = self.cost_of(point, index, &present, &noise)?;
            // Where the flanks would have the motor begin; then finer, because friction holds it at few of the twists.
            let mut middle_rad =
                present.twist_rad - present.offsets[0] / self.motions[index].counts_per_rad[0];
            for step_rad in [step_rad, step_rad / FINER] {
                let around_rad = middle_rad;
                for tried in -TRIED..=TRIED {
                    let twist_rad = around_rad + f64::from(tried) * step_rad;
                    let own = OwnParameters { twist_rad, offsets: [0.0, present.offsets[1]] };
                    let Some(cost) = self.cost_of(point, index, &own, &noise) else { continue };
                    if cost < least {
                        (least, middle_rad) = (cost, twist_rad);
                        next.own[index] = own;
                    }
                }
            }
        }
        let is_other = next.own.iter().zip(&point.own).any(|(next, own)| next.twist_rad != own.twist_rad);
        is_other.then_some(next)
    }

    fn cost_of(&self, point: &Point, index: usize, own: &OwnParameters, noise: &Noise) -> Option<f64> {
        let motion = &self.motions[index];
        let prediction = motion.predict(&point.vector, own, self.substeps)?;
        let of_encoder = |encoder: usize| {
            let used = (0..motion.samples()).filter(|&at| motion.is_used[encoder][at]);
            let squares =
                used.map(|at| noise.squared(encoder, residual(motion, &prediction, own, encoder, at)));
            squares.sum::<f64>() + (own.offsets[encoder] / motion.offset_deviation).powi(2)
        };
        Some(of_encoder(0) + of_encoder(1))
    }
}
