//! What is fitted: motions, parameters, residuals and their cost.

use crate::noise::{NINE_TENTHS, Noise, QUANTISATION};
use crate::parameters::{COUNT, Parameter, Vector};
use crate::prior::Prior;
use crate::replay::{Motion, OwnParameters, Prediction, Substeps};

/// Parameters of one motion: twist at the start, offsets of both encoders.
pub(crate) const OWN: usize = 3;

/// Parameters of the plant and of each motion.
#[derive(Clone)]
pub(crate) struct Point {
    pub(crate) vector: Vector,
    pub(crate) own: Vec<OwnParameters>,
}

/// What is fitted: motions, and the start that the prior is around.
pub(crate) struct Problem<'a> {
    pub(crate) motions: &'a [Motion],
    /// The motions that count.
    pub(crate) used: Vec<usize>,
    /// The parameters that the fit may move.
    pub(crate) is_free: [bool; COUNT],
    pub(crate) start: Vector,
    pub(crate) prior: Prior,
    pub(crate) substeps: Substeps,
}

impl Problem<'_> {
    pub(crate) fn size(&self) -> usize {
        COUNT + OWN * self.motions.len()
    }

    /// The motions that count, each with its parameters and its prediction.
    pub(crate) fn parts<'b>(
        &'b self,
        point: &'b Point,
        predictions: &'b [Prediction],
    ) -> impl Iterator<Item = (&'b Motion, &'b OwnParameters, &'b Prediction)> {
        self.used.iter().zip(predictions).map(|(&at, it)| (&self.motions[at], &point.own[at], it))
    }

    pub(crate) fn predict(&self, point: &Point) -> Option<Vec<Prediction>> {
        let predict = |&at: &usize| self.motions[at].predict(&point.vector, &point.own[at], self.substeps);
        self.used.iter().map(predict).collect()
    }

    /// Sum of squares of residuals and prior, in units of the quantisation.
    pub(crate) fn cost(&self, point: &Point, predictions: &[Prediction], noise: &Noise) -> f64 {
        let mut sum = 0.0;
        for (motion, own, prediction) in self.parts(point, predictions) {
            for encoder in 0..2 {
                for at in (0..motion.samples()).filter(|&at| motion.is_used[encoder][at]) {
                    sum += noise.squared(encoder, residual(motion, prediction, own, encoder, at));
                }
            }
            sum += own.offsets.iter().map(|it| (it / motion.offset_deviation).powi(2)).sum::<f64>();
        }
        let is_open = |it: &Parameter| self.prior.deviation(*it) > 0.0;
        let prior =
            |it: Parameter| ((point.vector.get(it) - self.start.get(it)) / self.prior.deviation(it)).powi(2);
        sum + Parameter::ALL.into_iter().filter(is_open).map(prior).sum::<f64>()
    }

    /// Root mean square of the residuals of an encoder in counts.
    pub(crate) fn root_mean_square(&self, point: &Point, predictions: &[Prediction], encoder: usize) -> f64 {
        let (mut sum, mut number) = (0.0, 0.0_f64);
        for (motion, own, prediction) in self.parts(point, predictions) {
            for at in (0..motion.samples()).filter(|&at| motion.is_used[encoder][at]) {
                sum += residual(motion, prediction, own, encoder, at).powi(2);
                number += 1.0;
            }
        }
        (sum / number.max(1.0)).sqrt()
    }

    /// Sum of the squares of both root mean squares. `None` if the model can't be followed.
    pub(crate) fn squares(&self, point: &Point) -> Option<f64> {
        let predictions = self.predict(point)?;
        Some([0, 1].map(|encoder| self.root_mean_square(point, &predictions, encoder).powi(2)).iter().sum())
    }

    pub(crate) fn noise(&self, point: &Point, predictions: &[Prediction]) -> Noise {
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

pub(crate) fn residual(
    motion: &Motion,
    prediction: &Prediction,
    own: &OwnParameters,
    encoder: usize,
    at: usize,
) -> f64 {
    motion.counts[encoder][at] - prediction.counts[encoder][at] - own.offsets[encoder]
}
