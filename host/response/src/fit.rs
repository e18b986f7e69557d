//! Stiffness, inertias, resonance and antiresonance of a measured plant, with intervals.
//!
//! Two masses on a shaft are fitted to the responses of motor and load together: Levenberg-Marquardt over the logarithms of the
//! parameters, each line weighted by its deviation. A grid of resonances and inertia ratios gives the starts. The intervals of 95 %
//! come from the covariance. Where the model leaves more than the deviations explain, they are wider by the root of that excess.

use std::f64::consts::TAU;
use std::fmt;

use nalgebra::{DMatrix, DVector};
use rustfft::num_complex::Complex;

use crate::response::{LEAST_COHERENCE, Line, Measured};
use crate::student;
use crate::two_mass::{Mode, TwoMass};

/// Parameters of the fit: the fields of [`TwoMass`].
const COUNT: usize = 9;
/// Lines that a fit needs: as many complex numbers as it has parameters, from either encoder.
const LEAST_LINES: usize = COUNT;
const ITERATIONS: usize = 60;
/// Least relative deviation of a line, from the first search to the last: far from the solution exact lines would make a landscape
/// of narrow valleys. The model with its images is not more exact than the last one.
const LEAST_DEVIATIONS: [f64; 3] = [0.3, 0.02, 3e-4];
/// Deviation of the prior around the start, in the logarithm: a factor of 50. It holds parameters that no line shows.
const PRIOR: f64 = 4.0;
/// Starts of the grid that are fitted to the end.
const STARTS: usize = 4;
/// Difference of a parameter's logarithm for the slopes.
const STEP: f64 = 1e-5;
/// Least delay that a logarithm starts from, in s.
const LEAST_TIME_S: f64 = 1e-5;

/// A value with its interval of 95 %.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Most likely value.
    pub value: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Estimate {
    /// Whether the interval contains a value.
    #[must_use]
    pub fn contains(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }
}

/// Why a response has no fit.
#[derive(Clone, PartialEq, thiserror::Error)]
pub enum FitError {
    /// Too few lines rise above their scatter.
    #[error(
        "{have} lines have a coherence of {LEAST_COHERENCE} or more, and two masses need {LEAST_LINES}; raise the amplitude or take \
         more realisations"
    )]
    TooFewLines {
        /// Coherent lines.
        have: usize,
    },
    /// No start of the fit led anywhere.
    #[error(
        "two masses on a shaft can't be fitted to the response; does the range of frequencies contain resonance and antiresonance?"
    )]
    NoFit,
}

/// As the message: a test that unwraps an error shows what to do.
impl fmt::Debug for FitError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, out)
    }
}

/// The drive train that explains a measured plant best.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// The drive train.
    pub train: TwoMass,
    /// Stiffness in N m/rad.
    pub stiffness_nm_rad: Estimate,
    /// Inertia of the motor in kg m^2.
    pub motor_inertia_kg_m2: Estimate,
    /// Inertia of the load in kg m^2, seen from the motor.
    pub load_inertia_kg_m2: Estimate,
    /// Inertia of the load over that of the motor.
    pub inertia_ratio: Estimate,
    /// Frequency of the antiresonance in Hz.
    pub antiresonance_hz: Estimate,
    /// Frequency of the resonance in Hz; `None` if it is damped away.
    pub resonance_hz: Option<Estimate>,
    /// Damping ratio of the antiresonance.
    pub antiresonance_damping: f64,
    /// Damping ratio of the resonance.
    pub resonance_damping: Option<f64>,
    /// Root mean square of what the model leaves, in units of the deviations: about 1 for a plant that is two masses.
    pub misfit: f64,
    /// Lines of the motor's response that the fit has used.
    pub lines: usize,
}

/// A line of either encoder, with its weight.
struct Datum {
    frequency_hz: f64,
    /// 0 for the motor, 1 for the load.
    encoder: usize,
    value: Complex<f64>,
    deviation: f64,
}

struct Problem {
    data: Vec<Datum>,
    period_s: f64,
    /// Least relative deviation.
    least: f64,
}

/// Logarithms of the parameters, in the order of [`to_train`].
type Logs = [f64; COUNT];

fn to_train(logs: &Logs) -> TwoMass {
    let [motor, load, stiffness, damping, motor_friction, load_friction, ratio, lag, delay] =
        logs.map(f64::exp);
    TwoMass {
        motor_inertia_kg_m2: motor,
        load_inertia_kg_m2: load,
        stiffness_nm_rad: stiffness,
        damping_nm_s_rad: damping,
        motor_friction_nm_s_rad: motor_friction,
        load_friction_nm_s_rad: load_friction,
        reduction_ratio: ratio,
        lag_s: lag,
        delay_s: delay,
    }
}

impl Fit {
    /// Fits two masses to the coherent lines of the plant. `delay_s` is about the time from a torque to the motor.
    ///
    /// # Errors
    /// Too few lines are coherent, or nothing fits.
    pub fn of(measured: &Measured, period_s: f64, delay_s: f64) -> Result<Self, FitError> {
        let mut problem = Problem::new(measured, period_s)?;
        let mut from = problem.starts(delay_s.max(LEAST_TIME_S));
        from.truncate(STARTS);
        for least in LEAST_DEVIATIONS {
            problem.least = least;
            from = from.into_iter().filter_map(|start| problem.solve(start)).collect();
        }
        let best = from.into_iter().min_by(|one, other| one.cost.total_cmp(&other.cost));
        best.and_then(|best| problem.fit(&best)).ok_or(FitError::NoFit)
    }
}

/// Where a search ended. The prior stays around where the first one began.
struct Solution {
    start: Logs,
    logs: Logs,
    cost: f64,
}

impl Problem {
    fn new(measured: &Measured, period_s: f64) -> Result<Self, FitError> {
        let mut data = Vec::new();
        for (encoder, lines) in [&measured.motor, &measured.load].into_iter().enumerate() {
            let deviations = smoothed(lines);
            for (line, deviation) in lines.iter().zip(deviations) {
                let is_coherent = line.coherence >= LEAST_COHERENCE && line.value.norm() > 0.0;
                if is_coherent {
                    data.push(Datum {
                        frequency_hz: line.frequency_hz,
                        encoder,
                        value: line.value,
                        deviation,
                    });
                }
            }
        }
        let have = data.iter().filter(|it| it.encoder == 0).count();
        if have < LEAST_LINES {
            return Err(FitError::TooFewLines { have });
        }
        Ok(Self { data, period_s, least: LEAST_DEVIATIONS[0] })
    }

    fn lines(&self) -> usize {
        self.data.iter().filter(|it| it.encoder == 0).count()
    }

    /// What a drive train leaves of every datum, real and imaginary part, in units of the deviation.
    fn residuals(&self, train: &TwoMass) -> Vec<f64> {
        let mut left = Vec::with_capacity(2 * self.data.len());
        let mut known: Option<(f64, [Complex<f64>; 2])> = None;
        for datum in &self.data {
            let model = match known {
                Some((frequency_hz, model)) if frequency_hz == datum.frequency_hz => model,
                _ => train.sampled(datum.frequency_hz, self.period_s),
            };
            known = Some((datum.frequency_hz, model));
            let deviation = datum.deviation.hypot(self.least * datum.value.norm());
            let error = (datum.value - model[datum.encoder]) / deviation;
            left.extend([error.re, error.im]);
        }
        left
    }

    fn cost(&self, logs: &Logs, start: &Logs) -> f64 {
        let squares: f64 = self.residuals(&to_train(logs)).iter().map(|it| it * it).sum();
        squares + logs.iter().zip(start).map(|(log, start)| ((log - start) / PRIOR).powi(2)).sum::<f64>()
    }

    /// Starts of the search, the best first: resonances and inertia ratios on a grid, the inertia of the motor by the motor's
    /// response far above the resonance, or by the whole of it below.
    fn starts(&self, delay_s: f64) -> Vec<Solution> {
        let motor: Vec<&Datum> = self.data.iter().filter(|it| it.encoder == 0).collect();
        let ratio = self.reduction_ratio();
        let [lowest_hz, highest_hz] = [motor[0], motor[motor.len() - 1]].map(|it| it.frequency_hz);
        let points = 24;
        let mut found: Vec<(f64, Logs)> = Vec::new();
        for point in 0..points {
            let share = (f64::from(point) + 0.5) / f64::from(points);
            let resonance = TAU * lowest_hz * (highest_hz / lowest_hz).powf(share);
            for inertia_ratio in [0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0] {
                let unit = TwoMass {
                    motor_inertia_kg_m2: 1.0,
                    load_inertia_kg_m2: inertia_ratio,
                    stiffness_nm_rad: resonance * resonance * inertia_ratio / (1.0 + inertia_ratio),
                    damping_nm_s_rad: 0.1 * resonance,
                    motor_friction_nm_s_rad: 0.05 * resonance,
                    load_friction_nm_s_rad: 0.05 * resonance,
                    reduction_ratio: ratio,
                    lag_s: LEAST_TIME_S,
                    delay_s,
                };
                // The one factor that all magnitudes share, as the mean of logarithms.
                let logs = |it: &&Datum| {
                    let model = unit.sampled(it.frequency_hz, self.period_s)[0].norm();
                    (it.value.norm() / model).ln()
                };
                let scale = motor.iter().map(logs).sum::<f64>() / motor.len() as f64;
                let spread: f64 = motor.iter().map(|it| (logs(it) - scale).powi(2)).sum();
                // Inertias, stiffness, damping and frictions are all in proportion to 1 / scale.
                let start = [
                    unit.motor_inertia_kg_m2,
                    unit.load_inertia_kg_m2,
                    unit.stiffness_nm_rad,
                    unit.damping_nm_s_rad,
                    unit.motor_friction_nm_s_rad,
                    unit.load_friction_nm_s_rad,
                ]
                .map(|it| it.ln() - scale);
                let [motor, load, stiffness, damping, motor_friction, load_friction] = start;
                let rest = [ratio.ln(), (0.2 * self.period_s).ln(), delay_s.ln()];
                let [ratio, lag, delay] = rest;
                let start =
                    [motor, load, stiffness, damping, motor_friction, load_friction, ratio, lag, delay];
                found.push((spread, start));
            }
        }
        found.sort_by(|one, other| one.0.total_cmp(&other.0));
        found.into_iter().map(|(cost, start)| Solution { start, logs: start, cost }).collect()
    }

    /// The ratio of both positions at the lowest lines, where the shaft is stiff.
    fn reduction_ratio(&self) -> f64 {
        let low = self.data.iter().find(|it| it.encoder == 1);
        let motor = low.and_then(|load| {
            self.data.iter().find(|it| it.encoder == 0 && it.frequency_hz == load.frequency_hz)
        });
        match (motor, low) {
            (Some(motor), Some(load)) => motor.value.norm() / load.value.norm(),
            _ => 1.0,
        }
    }

    /// Slopes of the residuals.
    fn slopes(&self, logs: &Logs, residuals: &[f64]) -> DMatrix<f64> {
        let mut slopes = DMatrix::zeros(residuals.len(), COUNT);
        for at in 0..COUNT {
            let mut moved = *logs;
            moved[at] += STEP;
            let moved = self.residuals(&to_train(&moved));
            for (row, (moved, from)) in moved.iter().zip(residuals).enumerate() {
                slopes[(row, at)] = (moved - from) / STEP;
            }
        }
        slopes
    }

    fn solve(&self, from: Solution) -> Option<Solution> {
        let Solution { start, mut logs, .. } = from;
        let mut damping = 1e-2;
        let mut cost = self.cost(&logs, &start);
        for _ in 0..ITERATIONS {
            let residuals = self.residuals(&to_train(&logs));
            let slopes = self.slopes(&logs, &residuals);
            let normal = slopes.transpose() * &slopes;
            let mut gradient = slopes.transpose() * DVector::from_column_slice(&residuals);
            for at in 0..COUNT {
                gradient[at] += (logs[at] - start[at]) / PRIOR.powi(2);
            }
            let mut gained = 0.0;
            for _ in 0..10 {
                let mut damped = normal.clone();
                for at in 0..COUNT {
                    damped[(at, at)] += damping * normal[(at, at)] + 1.0 / PRIOR.powi(2);
                }
                let Some(step) = damped.cholesky().map(|it| it.solve(&gradient)) else {
                    damping *= 10.0;
                    continue;
                };
                let mut next = logs;
                for at in 0..COUNT {
                    next[at] -= step[at].clamp(-1.0, 1.0);
                }
                let tried = self.cost(&next, &start);
                if tried < cost {
                    gained = (cost - tried) / cost;
                    (logs, cost) = (next, tried);
                    damping = (damping * 0.2).max(1e-9);
                    break;
                }
                damping *= 4.0;
            }
            if gained < 1e-7 {
                break;
            }
        }
        cost.is_finite().then_some(Solution { start, logs, cost })
    }

    fn fit(&self, solution: &Solution) -> Option<Fit> {
        let logs = &solution.logs;
        let train = to_train(logs);
        let residuals = self.residuals(&train);
        let slopes = self.slopes(logs, &residuals);
        let mut normal = slopes.transpose() * &slopes;
        for at in 0..COUNT {
            normal[(at, at)] += 1.0 / PRIOR.powi(2);
        }
        let freedom = (residuals.len() as f64 - COUNT as f64).max(1.0);
        let misfit = (residuals.iter().map(|it| it * it).sum::<f64>() / freedom).sqrt();
        let covariance = normal.try_inverse()? * misfit.max(1.0).powi(2);
        let t95 = student::within_95_percent(freedom);
        // Of the logarithm of a function of the parameters, by its slopes.
        let estimate = |of: &dyn Fn(&TwoMass) -> Option<f64>| -> Option<Estimate> {
            let value = of(&train)?;
            let mut slope = DVector::zeros(COUNT);
            for at in 0..COUNT {
                let mut moved = *logs;
                moved[at] += STEP;
                slope[at] = (of(&to_train(&moved))?.ln() - value.ln()) / STEP;
            }
            let within = t95 * (slope.transpose() * &covariance * &slope)[(0, 0)].max(0.0).sqrt();
            Some(Estimate { value, low: value * (-within).exp(), high: value * within.exp() })
        };
        Some(Fit {
            train,
            stiffness_nm_rad: estimate(&|it| Some(it.stiffness_nm_rad))?,
            motor_inertia_kg_m2: estimate(&|it| Some(it.motor_inertia_kg_m2))?,
            load_inertia_kg_m2: estimate(&|it| Some(it.load_inertia_kg_m2))?,
            inertia_ratio: estimate(&|it| Some(it.inertia_ratio()))?,
            antiresonance_hz: estimate(&|it| Some(it.antiresonance().frequency_hz))?,
            resonance_hz: estimate(&|it| it.resonance().map(|Mode { frequency_hz, .. }| frequency_hz)),
            antiresonance_damping: train.antiresonance().damping_ratio,
            resonance_damping: train.resonance().map(|it| it.damping_ratio),
            misfit,
            lines: self.lines(),
        })
    }
}

/// Deviations of lines, each with those of its neighbours: the scatter of a few realisations is itself uncertain.
fn smoothed(lines: &[Line]) -> Vec<f64> {
    let relative = |line: &Line| (line.deviation / line.value.norm()).powi(2);
    let around = |at: usize| &lines[at.saturating_sub(1)..(at + 2).min(lines.len())];
    let smooth = |at: usize| {
        let near = around(at);
        let mean = near.iter().map(relative).sum::<f64>() / near.len() as f64;
        mean.sqrt() * lines[at].value.norm()
    };
    (0..lines.len()).map(smooth).collect()
}

#[cfg(test)]
mod tests;
