//! Normal equations: differences of whole simulations, and the scatter of the gradient.

use nalgebra::{DMatrix, DVector};

use crate::noise::Noise;
use crate::parameters::{COUNT, Parameter, Vector};
use crate::problem::{OWN, Point, Problem, residual};
use crate::replay::{Altered, Motion, OwnParameters, Prediction};

/// Difference of the twist at the first sample, in rad.
const TWIST_STEP_RAD: f64 = 1e-4;
/// Time whose residuals count as one sample of the scatter: an error of the motor's breakaway lasts for a swing.
const CLUSTER_S: f64 = 0.06;

/// What the scatter is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Errors {
    /// The residuals.
    Counts,
    /// The residuals, and what is known of the errors of the torque.
    All,
}

/// Normal equations at a point.
pub(crate) struct Normal {
    pub(crate) matrix: DMatrix<f64>,
    pub(crate) gradient: DVector<f64>,
    /// Covariance of the gradient, from clusters of residuals.
    pub(crate) scatter: DMatrix<f64>,
    /// Root mean square of what the errors of the torque move the counts of motor and load by.
    pub(crate) explained_counts: [f64; 2],
}

impl Problem<'_> {
    pub(crate) fn normal(&self, point: &Point, predictions: &[Prediction], noise: &Noise) -> Option<Normal> {
        self.normal_with(point, predictions, noise, Errors::Counts, 1.0)
    }

    /// The predictions that differ by a step of one element each, with the step: those of the parameters, then the twist.
    /// `wider` multiplies the usual steps.
    pub(crate) fn columns(
        &self,
        motion: &Motion,
        base: &Prediction,
        vector: &Vector,
        own: &OwnParameters,
        wider: f64,
    ) -> Option<Vec<(f64, Prediction)>> {
        let mut columns = Vec::with_capacity(COUNT + 1);
        for parameter in Parameter::ALL {
            if !self.is_free[parameter as usize] {
                columns.push((1.0, base.clone()));
                continue;
            }
            let [low, high] = parameter.limits(self.start.get(parameter));
            let (value, step) = (vector.get(parameter), wider * self.prior.step(parameter));
            // At an end of its range an element moves the other way.
            let step = if (low..=high).contains(&(value + step)) { step } else { -step };
            let mut moved = *vector;
            moved.set(parameter, value + step);
            let is_of_encoder = Parameter::OF_ENCODERS.as_flattened().contains(&parameter);
            let prediction = if is_of_encoder {
                motion.reread(base, &moved, own)
            } else {
                motion.predict(&moved, own, self.substeps)?
            };
            columns.push((step, prediction));
        }
        let step = wider * TWIST_STEP_RAD;
        let moved = OwnParameters { twist_rad: own.twist_rad + step, ..*own };
        let moved = motion.predict(vector, &moved, self.substeps)?;
        columns.push((step, moved));
        Some(columns)
    }

    /// As [`normal`](Self::normal), with these errors in the scatter, and differences of steps that are so much wider.
    pub(crate) fn normal_with(
        &self,
        point: &Point,
        predictions: &[Prediction],
        noise: &Noise,
        errors: Errors,
        wider: f64,
    ) -> Option<Normal> {
        let size = self.size();
        let mut matrix = DMatrix::zeros(size, size);
        let mut gradient = DVector::zeros(size);
        let mut scatter = DMatrix::zeros(size, size);
        let kinds = self.motions.first().map_or(0, |motion| motion.altered.len());
        let kinds = if errors == Errors::All { kinds } else { 0 };
        let mut systematic = DMatrix::<f64>::zeros(size, kinds);
        let (mut squares, mut samples) = ([0.0; 2], [0.0_f64; 2]);
        for (base, &index) in predictions.iter().zip(&self.used) {
            let (motion, own) = (&self.motions[index], point.own[index]);
            let columns = self.columns(motion, base, &point.vector, &own, wider)?;
            let mut moved_by = Vec::with_capacity(kinds);
            for Altered { held, scale } in &motion.altered[..kinds] {
                let moved = motion.predict_under(held, &point.vector, &own, self.substeps)?;
                moved_by.push((*scale, moved));
            }
            let cluster = (CLUSTER_S / motion.period_s).ceil().max(1.0) as usize;
            let first = COUNT + OWN * index;
            let places: Vec<usize> = (0..COUNT).chain(first..first + OWN).collect();
            let mut row = [0.0; COUNT + OWN];
            let mut block = DMatrix::<f64>::zeros(places.len(), places.len());
            let mut spread = DMatrix::<f64>::zeros(places.len(), places.len());
            let mut slope = vec![0.0; places.len()];
            let mut bias = DMatrix::<f64>::zeros(places.len(), kinds);
            for encoder in 0..2 {
                let mut sum = vec![0.0; places.len()];
                for at in 0..motion.samples() {
                    if motion.is_used[encoder][at] {
                        let residual = residual(motion, base, &own, encoder, at);
                        let weight = noise.weight(encoder, residual);
                        let counts = noise.counts[encoder];
                        for (place, (step, moved)) in columns.iter().enumerate() {
                            row[place] =
                                (moved.counts[encoder][at] - base.counts[encoder][at]) / step / counts;
                        }
                        row[COUNT + 1] = 0.0;
                        row[COUNT + 2] = 0.0;
                        row[COUNT + 1 + encoder] = 1.0 / counts;
                        samples[encoder] += 1.0;
                        for (kind, (scale, moved)) in moved_by.iter().enumerate() {
                            let away_counts = scale * (moved.counts[encoder][at] - base.counts[encoder][at]);
                            squares[encoder] += away_counts.powi(2);
                            let away = weight * away_counts / counts;
                            for (i, &left) in row.iter().enumerate() {
                                bias[(i, kind)] += left * away;
                            }
                        }
                        let scaled = weight * residual / counts;
                        for (i, &left) in row.iter().enumerate() {
                            sum[i] += left * scaled;
                            slope[i] += left * scaled;
                            let left = left * weight;
                            for (j, &right) in row[..=i].iter().enumerate() {
                                block[(i, j)] += left * right;
                            }
                        }
                    }
                    if at % cluster == cluster - 1 || at + 1 == motion.samples() {
                        for (i, &left) in sum.iter().enumerate() {
                            for (j, &right) in sum[..=i].iter().enumerate() {
                                spread[(i, j)] += left * right;
                            }
                        }
                        sum.fill(0.0);
                    }
                }
            }
            for (i, &to) in places.iter().enumerate() {
                gradient[to] += slope[i];
                for kind in 0..kinds {
                    systematic[(to, kind)] += bias[(i, kind)];
                }
                for (j, &from) in places.iter().enumerate() {
                    let (low, high) = (i.max(j), i.min(j));
                    matrix[(to, from)] += block[(low, high)];
                    scatter[(to, from)] += spread[(low, high)];
                }
            }
            for encoder in 0..2 {
                let at = first + 1 + encoder;
                matrix[(at, at)] += motion.offset_deviation.powi(-2);
                gradient[at] -= own.offsets[encoder] * motion.offset_deviation.powi(-2);
            }
        }
        // A twist that no torque shows, and those of the motions that don't count.
        for index in 0..self.motions.len() {
            let first = COUNT + OWN * index;
            matrix[(first, first)] += 1.0;
            if !self.used.contains(&index) {
                matrix[(first + 1, first + 1)] += 1.0;
                matrix[(first + 2, first + 2)] += 1.0;
            }
        }
        for (at, parameter) in Parameter::ALL.into_iter().enumerate() {
            if self.prior.deviation(parameter) == 0.0 {
                matrix[(at, at)] += 1.0;
                continue;
            }
            let precision = self.prior.deviation(parameter).powi(-2);
            matrix[(at, at)] += precision;
            gradient[at] -= (point.vector.get(parameter) - self.start.get(parameter)) * precision;
            // The prior is as uncertain as it states.
            scatter[(at, at)] += precision;
        }
        // An error of the instruments is the same in all motions.
        scatter += &systematic * systematic.transpose();
        let explained_counts = [0, 1].map(|at| (squares[at] / samples[at].max(1.0)).sqrt());
        Some(Normal { matrix, gradient, scatter, explained_counts })
    }
}
