//! Nonlinear least squares: the parameters under which the plant model repeats the recorded counts.
//!
//! Levenberg-Marquardt. Each motion has three parameters of its own: the twist at its first sample, which no encoder knows,
//! and where within their first count both encoders stood.

use nalgebra::{DMatrix, DVector};

use crate::noise::{Noise, QUANTISATION};
use crate::normal::{Errors, Normal};
use crate::parameters::{COUNT, Parameter};
use crate::problem::{OWN, Point, Problem};
use crate::replay::{Prediction, Substeps};

/// Damping of the first step, and dampings that are tried in an iteration.
const DAMPING: f64 = 1e-3;
const TRIES: usize = 12;
/// Gain of an iteration, as a fraction of the cost, from which the fit has converged, and from which its equations stay.
const CONVERGED: f64 = 1e-4;
const SETTLED: f64 = 1e-2;
/// The same of a coarse fit, and of two iterations in a row of one that doesn't follow: where the motor sticks, a fit can creep for
/// long and gain nothing.
const CONVERGED_COARSE: f64 = 3e-3;
const CREEPS: f64 = 1e-3;
/// Steps of the differences, in usual ones, that follow where the usual ones to either side gain no more and the residuals aren't those
/// of the counts: where the motor is about to stick or to leave a dent, the least difference shows another motion.
const OTHER_STEPS: [f64; 2] = [10.0, -10.0];
/// Doublings of a step that are tried near the record.
const FARTHER: usize = 7;
/// Largest step of an element of the vector.
const STEP_MAX: f64 = 0.7;

/// A fit with the covariance of its parameters.
pub(crate) struct Fit {
    pub(crate) point: Point,
    /// Covariance of the plant's parameters, in the scale of the vector.
    pub(crate) covariance: DMatrix<f64>,
    /// Root mean square of the residuals of both encoders, in counts.
    pub(crate) residual_counts: [f64; 2],
    /// What the errors of the torque explain of it.
    pub(crate) explained_counts: [f64; 2],
    /// Counts of the cogging per turn under which the model is about as near, the nearest first; none if it is about as near
    /// without cogging.
    pub(crate) per_turn: Vec<u32>,
}

/// Residual of a model that follows, in counts: quantisation alone leaves 0.29.
const FOLLOWS_COUNTS: f64 = 1.0;
/// Standard deviations of the errors of the torque that it may have on top.
const EXPLAINED: f64 = 2.0;

/// Residual of a model that leaves nothing but quantisation, over that of the quantisation.
const EXACT: f64 = 1.2;
/// Factor per root of the excess of the squares, chosen on plants 8010 to 8033 with errors of torque and encoders.
const DOUBT: f64 = 5.0;

/// Whether residuals of motor and load are about those of the quantisation, of errors of the torque, and of encoders whose edges
/// jitter uniformly by up to `noise_counts` in either direction.
pub(crate) fn follows(residual_counts: [f64; 2], explained_counts: [f64; 2], noise_counts: f64) -> bool {
    let noise = noise_counts / 3.0_f64.sqrt();
    let mut pairs = residual_counts.into_iter().zip(explained_counts);
    pairs.all(|(counts, explained)| counts < FOLLOWS_COUNTS.hypot(EXPLAINED * explained).hypot(noise))
}

impl Fit {
    /// Takes the parts of a cogging that isn't likely from a fit that has it.
    pub(crate) fn take_cogging(&mut self, other: &Self) {
        self.point.vector.cogging_per_turn = other.point.vector.cogging_per_turn;
        self.per_turn.clear();
        let places = Parameter::COGGING.map(|it| it as usize);
        for (at, parameter) in places.into_iter().zip(Parameter::COGGING) {
            self.point.vector.set(parameter, other.point.vector.get(parameter));
            for from in places {
                self.covariance[(at, from)] = other.covariance[(at, from)];
            }
        }
    }

    /// Sum of the squares of both residuals.
    pub(crate) fn squares(&self) -> f64 {
        self.residual_counts.iter().map(|it| it * it).sum()
    }

    /// Whether the residuals are those of quantisation, noise and the errors of the torque, and nothing else.
    pub(crate) fn is_exact(&self, noise_counts: f64) -> bool {
        let noise = noise_counts / 3.0_f64.sqrt();
        let mut pairs = self.residual_counts.into_iter().zip(self.explained_counts);
        pairs.all(|(counts, explained)| {
            counts < (EXACT * QUANTISATION).hypot(EXPLAINED * explained).hypot(EXACT * noise)
        })
    }

    pub(crate) fn is_followed(&self, noise_counts: f64) -> bool {
        follows(self.residual_counts, self.explained_counts, noise_counts)
    }
}

impl Problem<'_> {
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

    /// Factor on the deviations of a model that leaves more than quantisation and noise: the rest isn't random, so its scatter
    /// shows too little of what it does to the estimates.
    fn doubt(&self, residual_counts: [f64; 2], explained_counts: [f64; 2]) -> f64 {
        let noise_counts = self.motions.first().map_or(0.0, |motion| motion.noise_counts);
        let explained = |at: usize| {
            (EXACT * QUANTISATION).powi(2)
                + noise_counts.powi(2) / 3.0
                + (EXPLAINED * explained_counts[at]).powi(2)
        };
        let excess = [0, 1].map(|at| (residual_counts[at].powi(2) / explained(at) - 1.0).max(0.0));
        1.0 + DOUBT * excess[0].max(excess[1]).sqrt()
    }

    /// The point after a damped step, as far along it as the cost falls, by up to `farther` doublings, with what it has less of the
    /// cost. Damping that a step across
    /// a valley needs makes those along it short.
    fn less(
        &self,
        point: &Point,
        normal: &Normal,
        damping: f64,
        noise: &Noise,
        (cost, farther): (f64, usize),
    ) -> Option<(Point, Vec<Prediction>, f64)> {
        let mut step = self.step(point, normal, damping)?;
        let mut farthest = None;
        let mut least = 0.0;
        for _ in 0..=farther {
            let next = self.moved(point, &step);
            let Some(tried) = self.predict(&next) else { break };
            let less = cost - self.cost(&next, &tried, noise);
            if less <= least {
                break;
            }
            least = less;
            farthest = Some((next, tried, less));
            step *= 2.0;
        }
        farthest
    }

    /// Fits from `point` on. `None` if the model can't be followed at the start.
    pub(crate) fn fit(&self, mut point: Point, iterations: usize) -> Option<Fit> {
        let mut predictions = self.predict(&point)?;
        let mut damping = DAMPING;
        let mut last = None;
        let mut others = OTHER_STEPS.into_iter();
        let (mut wider, mut before) = (1.0, f64::INFINITY);
        // How often in a row the fit has converged, with differences to the one side and to the other.
        let mut sides = 0;
        let mut first = None;
        let converged = if self.substeps == Substeps::Coarse { CONVERGED_COARSE } else { CONVERGED };
        let noise_counts = self.motions.first().map_or(0.0, |motion| motion.noise_counts);
        let is_near = |point: &Point, predictions: &[Prediction]| {
            let residual_counts = [0, 1].map(|encoder| self.root_mean_square(point, predictions, encoder));
            self.substeps != Substeps::Coarse && follows(residual_counts, [0.0; 2], noise_counts)
        };
        for _ in 0..iterations {
            let noise = self.noise(&point, &predictions);
            let cost = self.cost(&point, &predictions, &noise);
            let normal = self.normal_with(&point, &predictions, &noise, Errors::Counts, wider)?;
            // Far from the record the linear equations know too little of the way.
            let farther = if is_near(&point, &predictions) { FARTHER } else { 0 };
            let mut gained = 0.0;
            for _ in 0..TRIES {
                if let Some((next, tried, less)) =
                    self.less(&point, &normal, damping, &noise, (cost, farther))
                {
                    gained = less / cost;
                    (point, predictions) = (next, tried);
                    damping = (damping * 0.1).max(1e-9);
                    break;
                }
                damping *= 10.0;
            }
            // The normal equations barely change over such a step, and they are most of the work.
            last = (gained < SETTLED && wider == 1.0).then_some(normal);
            if gained >= converged && (is_near(&point, &predictions) || gained.max(before) >= CREEPS) {
                (before, sides) = (gained, 0);
                continue;
            }
            before = f64::INFINITY;
            sides += 1;
            first.get_or_insert(point.vector);
            let residual_counts = [0, 1].map(|encoder| self.root_mean_square(&point, &predictions, encoder));
            let doubts = self.doubt(residual_counts, [0.0; 2]) > 1.0;
            let other = if sides < 2 && (doubts || self.substeps != Substeps::Coarse) {
                Some(-wider)
            } else {
                others.next().filter(|_| doubts)
            };
            let Some(other) = other else { break };
            (wider, damping) = (other, DAMPING);
        }
        let is_exact = self.motions.iter().all(|motion| motion.altered.is_empty());
        let normal = match last {
            Some(normal) if is_exact || self.substeps == Substeps::Coarse => normal,
            _ => {
                let noise = self.noise(&point, &predictions);
                let errors = if self.substeps == Substeps::Coarse { Errors::Counts } else { Errors::All };
                self.normal_with(&point, &predictions, &noise, errors, 1.0)?
            }
        };
        let inverse = normal.matrix.try_inverse()?;
        let residual_counts = [0, 1].map(|encoder| self.root_mean_square(&point, &predictions, encoder));
        let per_turn = vec![point.vector.cogging_per_turn];
        let explained_counts = normal.explained_counts;
        let doubt = self.doubt(residual_counts, explained_counts);
        let mut covariance = &inverse * &normal.scatter * &inverse * doubt.powi(2);
        // Where the motor sticks and lets go, differences to the one side lead to another point than those to the other.
        let apart = |it: Parameter| first.map_or(0.0, |first| point.vector.get(it) - first.get(it));
        for (i, left) in Parameter::ALL.into_iter().enumerate() {
            for (j, right) in Parameter::ALL.into_iter().enumerate() {
                covariance[(i, j)] += 0.5 * apart(left) * apart(right);
            }
        }
        Some(Fit { point, covariance, residual_counts, explained_counts, per_turn })
    }
}
