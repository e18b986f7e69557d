//! Twists at the first sample, where a fit has put the motor into the wrong dent of the cogging.
//!
//! A motor at rest stands in one of the dents that the cogging makes. No small step of the twist leads from one to the
//! next, so a fit stays in that from which it began.

use std::f64::consts::TAU;

use crate::noise::Noise;
use crate::problem::{Point, Problem, residual};
use crate::replay::OwnParameters;

/// Twists that are tried on either side, and how many of them are in a dent.
const TRIED: i32 = 16;
const IN_DENT: f64 = 8.0;

impl Problem<'_> {
    /// The point with the twists under which each motion is the nearest to its record; `None` if they are those of the
    /// point.
    pub(crate) fn other_dents(&self, point: &Point) -> Option<Point> {
        let noise = self.noise(point, &self.predict(point)?);
        let step_rad = TAU / f64::from(point.vector.cogging_per_turn) / IN_DENT;
        let mut next = point.clone();
        for &index in &self.used {
            let present = point.own[index];
            let mut least = self.cost_of(point, index, &present, &noise)?;
            // Where the flanks would have the motor begin.
            let shifted_rad = present.twist_rad - present.offsets[0] / self.motions[index].counts_per_rad[0];
            for tried in -TRIED..=TRIED {
                let twist_rad = shifted_rad + f64::from(tried) * step_rad;
                let own = OwnParameters { twist_rad, offsets: [0.0, present.offsets[1]] };
                let Some(cost) = self.cost_of(point, index, &own, &noise) else { continue };
                if cost < least {
                    least = cost;
                    next.own[index] = own;
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
