//! Nonlinear least squares: the parameters under which the plant model repeats the recorded counts.
//!
//! Levenberg-Marquardt with differences of whole simulations. Each motion has three parameters of its own: the twist at
//! its first sample, which no encoder knows, and where within their first count both encoders stood.

use nalgebra::{DMatrix, DVector};

use crate::parameters::{COUNT, Parameter, Vector};
use crate::replay::{Motion, Prediction, Substeps};

/// Parameters of one motion: twist at the start, offsets of both encoders.
const OWN: usize = 3;
/// Standard deviation of an encoder's offset within its count.
const OFFSET_DEVIATION: f64 = 0.4;
/// Standard deviation of the quantisation in counts, 1 / sqrt(12).
pub(crate) const QUANTISATION: f64 = 0.288_675;
const STEP: f64 = 1e-4;
/// Dampings that are tried in an iteration.
const TRIES: usize = 8;
/// Gain of an iteration, as a fraction of the cost, from which the fit has converged, and from which its equations stay.
const CONVERGED: f64 = 1e-4;
const SETTLED: f64 = 1e-2;
/// Largest step of an element of the vector.
const STEP_MAX: f64 = 0.7;

/// Parameters of the plant and of each motion.
#[derive(Clone)]
pub(crate) struct Point {
    pub(crate) vector: Vector,
    pub(crate) own: Vec<OwnParameters>,
}

#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct OwnParameters {
    pub(crate) twist_rad: f64,
    pub(crate) offsets: [f64; 2],
}

/// A fit with the covariance of its parameters.
pub(crate) struct Fit {
    pub(crate) point: Point,
    /// Covariance of the plant's parameters, in the scale of the vector.
    pub(crate) covariance: DMatrix<f64>,
    /// Root mean square of the residuals of both encoders, in counts.
    pub(crate) residual_counts: [f64; 2],
}

/// Residual of a model that follows, in counts: quantisation alone leaves 0.29.
const FOLLOWS_COUNTS: f64 = 1.0;

/// Whether residuals of motor and load are about those of the quantisation.
pub(crate) fn follows(residual_counts: [f64; 2]) -> bool {
    residual_counts.iter().all(|&counts| counts < FOLLOWS_COUNTS)
}

impl Fit {
    pub(crate) fn is_followed(&self) -> bool {
        follows(self.residual_counts)
    }
}

/// What is fitted: motions, and the start that the prior is around.
pub(crate) struct Problem<'a> {
    pub(crate) motions: &'a [Motion],
    /// The motions that count.
    pub(crate) used: Vec<usize>,
    /// The parameters that the fit may move.
    pub(crate) is_free: [bool; COUNT],
    pub(crate) start: Vector,
    pub(crate) substeps: Substeps,
}

/// Normal equations at a point.
struct Normal {
    matrix: DMatrix<f64>,
    gradient: DVector<f64>,
    /// Covariance of the gradient, from clusters of residuals.
    scatter: DMatrix<f64>,
}

impl Problem<'_> {
    fn size(&self) -> usize {
        COUNT + OWN * self.motions.len()
    }

    /// The motions that count, each with its parameters and its prediction.
    fn parts<'b>(
        &'b self,
        point: &'b Point,
        predictions: &'b [Prediction],
    ) -> impl Iterator<Item = (&'b Motion, &'b OwnParameters, &'b Prediction)> {
        self.used.iter().zip(predictions).map(|(&at, it)| (&self.motions[at], &point.own[at], it))
    }

    fn predict(&self, point: &Point) -> Option<Vec<Prediction>> {
        let predict =
            |&at: &usize| self.motions[at].predict(&point.vector, point.own[at].twist_rad, self.substeps);
        self.used.iter().map(predict).collect()
    }

    /// Sum of squares of residuals and prior, in units of the quantisation.
    fn cost(&self, point: &Point, predictions: &[Prediction], noise: &Noise) -> f64 {
        let mut sum = 0.0;
        for (motion, own, prediction) in self.parts(point, predictions) {
            for encoder in 0..2 {
                for at in (0..motion.samples()).filter(|&at| motion.is_used[encoder][at]) {
                    sum += noise.squared(encoder, residual(motion, prediction, own, encoder, at));
                }
            }
            sum += own.offsets.iter().map(|it| (it / OFFSET_DEVIATION).powi(2)).sum::<f64>();
        }
        let prior =
            |it: Parameter| ((point.vector.get(it) - self.start.get(it)) / it.prior_deviation()).powi(2);
        sum + Parameter::ALL.into_iter().map(prior).sum::<f64>()
    }

    fn normal(&self, point: &Point, predictions: &[Prediction], noise: &Noise) -> Option<Normal> {
        let size = self.size();
        let mut matrix = DMatrix::zeros(size, size);
        let mut gradient = DVector::zeros(size);
        let mut scatter = DMatrix::zeros(size, size);
        for (base, &index) in predictions.iter().zip(&self.used) {
            let (motion, own) = (&self.motions[index], point.own[index]);
            let mut columns = Vec::with_capacity(COUNT + 1);
            for parameter in Parameter::ALL {
                if !self.is_free[parameter as usize] {
                    columns.push((STEP, base.clone()));
                    continue;
                }
                let mut moved = point.vector;
                moved.set(parameter, moved.get(parameter) + STEP);
                columns.push((STEP, motion.predict(&moved, own.twist_rad, self.substeps)?));
            }
            columns.push((STEP, motion.predict(&point.vector, own.twist_rad + STEP, self.substeps)?));
            let cluster = (0.02 / motion.period_s).ceil().max(1.0) as usize;
            let first = COUNT + OWN * index;
            let places: Vec<usize> = (0..COUNT).chain(first..first + OWN).collect();
            let mut row = vec![0.0; COUNT + OWN];
            let mut block = DMatrix::<f64>::zeros(places.len(), places.len());
            let mut spread = DMatrix::<f64>::zeros(places.len(), places.len());
            let mut slope = vec![0.0; places.len()];
            for encoder in 0..2 {
                let mut sum = vec![0.0; places.len()];
                for at in 0..motion.samples() {
                    if motion.is_used[encoder][at] {
                        let residual = residual(motion, base, &own, encoder, at);
                        let weight = noise.weight(encoder, residual);
                        let counts = noise.counts[encoder];
                        for (place, (step, moved)) in columns.iter().enumerate() {
                            row[place] = (moved[encoder][at] - base[encoder][at]) / step / counts;
                        }
                        row[COUNT + 1] = 0.0;
                        row[COUNT + 2] = 0.0;
                        row[COUNT + 1 + encoder] = 1.0 / counts;
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
                for (j, &from) in places.iter().enumerate() {
                    let (low, high) = (i.max(j), i.min(j));
                    matrix[(to, from)] += block[(low, high)];
                    scatter[(to, from)] += spread[(low, high)];
                }
            }
            for encoder in 0..2 {
                let at = first + 1 + encoder;
                matrix[(at, at)] += OFFSET_DEVIATION.powi(-2);
                gradient[at] -= own.offsets[encoder] * OFFSET_DEVIATION.powi(-2);
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
            let precision = parameter.prior_deviation().powi(-2);
            matrix[(at, at)] += precision;
            gradient[at] -= (point.vector.get(parameter) - self.start.get(parameter)) * precision;
            // The prior is as uncertain as it states.
            scatter[(at, at)] += precision;
        }
        Some(Normal { matrix, gradient, scatter })
    }

    /// The damped step. An element that would leave its range goes to the end of it, and the others make the best of that.
    fn step(&self, point: &Point, normal: &Normal, damping: f64) -> Option<DVector<f64>> {
        let mut fixed = [None; COUNT];
        loop {
            let (mut matrix, mut gradient) = (normal.matrix.clone(), normal.gradient.clone());
            for at in 0..matrix.nrows() {
                matrix[(at, at)] *= 1.0 + damping;
            }
            for (at, fixed) in fixed.iter().enumerate() {
                let Some(moved) = *fixed else { continue };
                gradient -= matrix.column(at) * moved;
                matrix.row_mut(at).fill(0.0);
                matrix.column_mut(at).fill(0.0);
                matrix[(at, at)] = 1.0;
            }
            for (at, fixed) in fixed.iter().enumerate() {
                if let Some(moved) = *fixed {
                    gradient[at] = moved;
                }
            }
            let mut step = matrix.cholesky()?.solve(&gradient);
            let largest = step.iter().take(COUNT).fold(0.0_f64, |largest, it| largest.max(it.abs()));
            step *= (STEP_MAX / largest).min(1.0);
            let leaves = |&at: &usize| {
                let parameter = Parameter::ALL[at];
                let value = point.vector.get(parameter);
                let [low, high] = parameter.limits(self.start.get(parameter));
                !(low - 1e-12..=high + 1e-12).contains(&parameter.moved(value, step[at]))
            };
            let Some(at) = (0..COUNT).filter(|&at| fixed[at].is_none()).find(leaves) else {
                return Some(step);
            };
            let parameter = Parameter::ALL[at];
            let value = point.vector.get(parameter);
            let [low, high] = parameter.limits(self.start.get(parameter));
            let end = parameter.moved(value, step[at]).clamp(low, high);
            fixed[at] = Some(parameter.step_between(value, end));
        }
    }

    fn moved(&self, point: &Point, step: &DVector<f64>) -> Point {
        let mut next = point.clone();
        for parameter in Parameter::ALL {
            let (value, step) = (point.vector.get(parameter), step[parameter as usize]);
            next.vector.set(parameter, parameter.moved(value, step));
        }
        next.vector.clamp(&self.start);
        for (index, own) in next.own.iter_mut().enumerate() {
            let first = COUNT + OWN * index;
            own.twist_rad += step[first];
            own.offsets = [0, 1].map(|encoder| own.offsets[encoder] + step[first + 1 + encoder]);
        }
        next
    }

    /// Fits from `point` on. `None` if the model can't be followed at the start.
    pub(crate) fn fit(&self, mut point: Point, iterations: usize) -> Option<Fit> {
        let mut predictions = self.predict(&point)?;
        let mut damping = 1e-3;
        let mut last = None;
        for _ in 0..iterations {
            let noise = self.noise(&point, &predictions);
            let cost = self.cost(&point, &predictions, &noise);
            let normal = self.normal(&point, &predictions, &noise)?;
            let mut gained = 0.0;
            for _ in 0..TRIES {
                let next = self.step(&point, &normal, damping).map(|step| self.moved(&point, &step));
                let tried = next.and_then(|next| Some((self.predict(&next)?, next)));
                if let Some((tried, next)) = tried {
                    let less = cost - self.cost(&next, &tried, &noise);
                    if less > 0.0 {
                        gained = less / cost;
                        (point, predictions) = (next, tried);
                        damping = (damping * 0.1).max(1e-9);
                        break;
                    }
                }
                damping *= 10.0;
            }
            // The normal equations hardly change any more over such a step, and they are most of the work.
            last = (gained < SETTLED).then_some(normal);
            if gained < CONVERGED {
                break;
            }
        }
        let normal = match last {
            Some(normal) => normal,
            None => self.normal(&point, &predictions, &self.noise(&point, &predictions))?,
        };
        let inverse = normal.matrix.try_inverse()?;
        let covariance = &inverse * &normal.scatter * &inverse;
        let residual_counts = [0, 1].map(|encoder| self.root_mean_square(&point, &predictions, encoder));
        Some(Fit { point, covariance, residual_counts })
    }

    /// Root mean square of the residuals of an encoder in counts.
    fn root_mean_square(&self, point: &Point, predictions: &[Prediction], encoder: usize) -> f64 {
        let (mut sum, mut number) = (0.0, 0.0_f64);
        for (motion, own, prediction) in self.parts(point, predictions) {
            for at in (0..motion.samples()).filter(|&at| motion.is_used[encoder][at]) {
                sum += residual(motion, prediction, own, encoder, at).powi(2);
                number += 1.0;
            }
        }
        (sum / number.max(1.0)).sqrt()
    }

    fn noise(&self, point: &Point, predictions: &[Prediction]) -> Noise {
        let high = |encoder: usize| {
            let mut residuals = Vec::new();
            for (motion, own, prediction) in self.parts(point, predictions) {
                let used = (0..motion.samples()).filter(|&at| motion.is_used[encoder][at]);
                residuals.extend(used.map(|at| residual(motion, prediction, own, encoder, at).abs()));
            }
            residuals.sort_by(f64::total_cmp);
            residuals.get(residuals.len() * 9 / 10).copied().unwrap_or(0.0)
        };
        Noise { counts: [0, 1].map(|encoder| (high(encoder) / NINE_TENTHS).max(QUANTISATION)) }
    }
}

/// What a residual is worth, from the residuals themselves: as long as the model is far from the record, the prior keeps
/// the fit from explaining all of it by what the record hardly shows.
#[derive(Debug, Clone, Copy)]
struct Noise {
    /// Standard deviation of each encoder, in counts.
    counts: [f64; 2],
}

/// Standard deviations within which nine tenths of normal residuals are.
const NINE_TENTHS: f64 = 1.645;
/// Standard deviations beyond which a residual counts less.
const OUTLIER: f64 = 4.0;

impl Noise {
    /// Square of a residual in units of the noise, of Huber's kind: linear for outliers.
    fn squared(&self, encoder: usize, residual: f64) -> f64 {
        let size = residual.abs() / self.counts[encoder];
        if size <= OUTLIER { size * size } else { OUTLIER * (2.0 * size - OUTLIER) }
    }

    fn weight(&self, encoder: usize, residual: f64) -> f64 {
        (OUTLIER * self.counts[encoder] / residual.abs()).min(1.0)
    }
}

fn residual(motion: &Motion, prediction: &Prediction, own: &OwnParameters, encoder: usize, at: usize) -> f64 {
    motion.counts[encoder][at] - prediction[encoder][at] - own.offsets[encoder]
}
