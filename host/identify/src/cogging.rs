//! The cogging of the motor: how many periods it has per turn.
//!
//! Its two parts of cosine and sine are parameters of the fit, but the count per turn isn't: a step of it changes the phase
//! by turns. So every count is tried. What its two parts would leave of the residuals, the other parameters being free to
//! follow, ranks the counts, and the fit is made with the first few.

use nalgebra::{DMatrix, DVector, Matrix2, Vector2};

use crate::parameters::{COUNT, Parameter};
use crate::problem::{OWN, Point, Problem, residual};
use crate::replay::Prediction;

/// Most periods per turn that are tried.
pub(crate) const PER_TURN_MAX: u32 = 48;
/// Largest first amplitude of each part, in standard deviations of the prior.
const LARGEST: f64 = 1.0;

/// A count per turn with what it explains.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Candidate {
    pub(crate) per_turn: u32,
    /// Parts of cosine and sine, in N m.
    pub(crate) parts_nm: [f64; 2],
    /// Reduction of the cost.
    pub(crate) gain: f64,
}

impl Candidate {
    /// That of a point.
    pub(crate) fn of(point: &Point) -> Self {
        let parts_nm = Parameter::COGGING.map(|it| point.vector.get(it));
        Self { per_turn: point.vector.cogging_per_turn, parts_nm, gain: 0.0 }
    }

    /// The point with this cogging.
    pub(crate) fn put_on(&self, point: &Point) -> Point {
        let mut next = point.clone();
        next.vector.cogging_per_turn = self.per_turn;
        for (parameter, part_nm) in Parameter::COGGING.into_iter().zip(self.parts_nm) {
            next.vector.set(parameter, part_nm);
        }
        next
    }
}

impl Problem<'_> {
    /// All counts per turn, that which explains the most first. The problem's fit has no cogging.
    pub(crate) fn cogging(&self, point: &Point) -> Option<Vec<Candidate>> {
        let predictions = self.predict(point)?;
        let noise = self.noise(point, &predictions);
        let normal = self.normal(point, &predictions, &noise)?;
        let others = normal.matrix.cholesky()?;
        let mut sums = vec![Sums::new(self.size()); PER_TURN_MAX as usize];
        for (base, &index) in predictions.iter().zip(&self.used) {
            let (motion, own) = (&self.motions[index], point.own[index]);
            let columns = self.columns(motion, base, &point.vector, &own, 1.0)?;
            let mut tried = Vec::new();
            for per_turn in 1..=PER_TURN_MAX {
                let part = |parameter: Parameter| {
                    let mut moved = point.vector;
                    moved.cogging_per_turn = per_turn;
                    moved.set(parameter, self.prior.step(parameter));
                    motion.predict(&moved, &own, self.substeps)
                };
                tried.push([part(Parameter::CoggingCosine)?, part(Parameter::CoggingSine)?]);
            }
            let step_nm = self.prior.step(Parameter::CoggingCosine);
            let first = COUNT + OWN * index;
            let mut row = [0.0; COUNT + OWN];
            for encoder in 0..2 {
                let slope = |moved: &Prediction, step: f64, at: usize| {
                    (moved.counts[encoder][at] - base.counts[encoder][at]) / step / noise.counts[encoder]
                };
                for at in (0..motion.samples()).filter(|&at| motion.is_used[encoder][at]) {
                    let away = residual(motion, base, &own, encoder, at);
                    let weight = noise.weight(encoder, away);
                    let away = away / noise.counts[encoder];
                    for (place, (step, moved)) in columns.iter().enumerate() {
                        row[place] = slope(moved, *step, at);
                    }
                    row[COUNT + 1] = 0.0;
                    row[COUNT + 2] = 0.0;
                    row[COUNT + 1 + encoder] = 1.0 / noise.counts[encoder];
                    for (sums, tried) in sums.iter_mut().zip(&tried) {
                        let parts = [0, 1].map(|part| slope(&tried[part], step_nm, at));
                        sums.add(&row, first, parts, weight, away);
                    }
                }
            }
        }
        let precision = self.prior.deviation(Parameter::CoggingCosine).powi(-2);
        let mut found: Vec<_> = (1..=PER_TURN_MAX)
            .zip(sums)
            .filter_map(|(per_turn, sums)| {
                // What the others leave of the two parts and of the residuals.
                let solved = others.solve(&sums.mixed);
                let square = sums.square - sums.mixed.transpose() * &solved + Matrix2::identity() * precision;
                let right = sums.right - solved.transpose() * &normal.gradient;
                let right = Vector2::new(right[0], right[1]);
                let square = Matrix2::new(square[(0, 0)], square[(0, 1)], square[(1, 0)], square[(1, 1)]);
                let parts = square.try_inverse()? * right;
                let most_nm = LARGEST / precision.sqrt();
                let parts_nm = [parts[0], parts[1]].map(|it| it.clamp(-most_nm, most_nm));
                Some(Candidate { per_turn, parts_nm, gain: right.dot(&parts) })
            })
            .collect();
        found.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        Some(found)
    }
}

/// Products of the two parts with themselves, with all other parameters and with the residuals.
#[derive(Clone)]
struct Sums {
    square: DMatrix<f64>,
    mixed: DMatrix<f64>,
    right: DVector<f64>,
}

impl Sums {
    fn new(size: usize) -> Self {
        Self { square: DMatrix::zeros(2, 2), mixed: DMatrix::zeros(size, 2), right: DVector::zeros(2) }
    }

    fn add(&mut self, row: &[f64; COUNT + OWN], first: usize, parts: [f64; 2], weight: f64, away: f64) {
        for (i, left) in parts.into_iter().enumerate() {
            let left = left * weight;
            self.right[i] += left * away;
            for (j, right) in parts.into_iter().enumerate() {
                self.square[(i, j)] += left * right;
            }
            for (place, value) in row.iter().enumerate() {
                let to = if place < COUNT { place } else { first + place - COUNT };
                self.mixed[(to, i)] += left * value;
            }
        }
    }
}
