//! The motor from the motions in which the load stays at rest.

use crate::fit::Fit;
use crate::parameters::{COUNT, Parameter};
use crate::prior::Prior;
use crate::problem::{Point, Problem};
use crate::replay::{Motion, Substeps};

/// What a motion of the motor alone shows.
const MOTOR: [bool; COUNT] = {
    let mut free = [false; COUNT];
    free[Parameter::MotorInertia as usize] = true;
    free[Parameter::MotorCoulomb as usize] = true;
    free[Parameter::MotorExcess as usize] = true;
    free[Parameter::Stiffness as usize] = true;
    free[Parameter::DeadZone as usize] = true;
    free[Parameter::ShaftDamping as usize] = true;
    free[Parameter::TorqueOffset as usize] = true;
    free
};

/// Range of the search for the motor's inertia around the start, as a logarithm, and its steps.
const SEARCH: f64 = 4.2;
const SEARCH_STEPS: i32 = 9;
/// Inertias that a fit is started from, at most.
const CANDIDATES: usize = 4;
/// Residual of a fit that needs no other candidate, as a fraction of the motor's range.
const GOOD: f64 = 0.01;

/// Fits the motor to the motions of the motor alone. The inertia is first searched for, with a shaft damped by 5 % of
/// critical.
pub(crate) fn motor(motions: &[Motion], still: &[usize], point: Point, prior: &Prior) -> Point {
    let start = point.vector.get(Parameter::MotorInertia);
    let tried = (-SEARCH_STEPS..=SEARCH_STEPS).map(|step| {
        let mut next = point.clone();
        let inertia = start + SEARCH * f64::from(step) / f64::from(SEARCH_STEPS);
        next.vector.set(Parameter::MotorInertia, inertia);
        let damping = 0.1_f64.ln() + 0.5 * (inertia + next.vector.get(Parameter::Stiffness));
        next.vector.set(Parameter::ShaftDamping, damping);
        (distance(motions, still, &next), step, next)
    });
    let mut tried: Vec<_> = tried.collect();
    tried.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut candidates: Vec<(i32, Point)> = Vec::new();
    for (_, step, next) in tried {
        if candidates.len() < CANDIDATES && candidates.iter().all(|(other, _)| (other - step).abs() > 1) {
            candidates.push((step, next));
        }
    }
    let ranges = still.iter().map(|&at| range(&motions[at].counts[0]));
    let good = GOOD * ranges.fold(1.0, f64::max);
    let mut best: Option<Fit> = None;
    let first = candidates.first().map(|(_, point)| point.clone());
    for (_, candidate) in candidates {
        let problem = Problem {
            motions,
            used: still.to_vec(),
            start: candidate.vector,
            prior: *prior,
            is_free: MOTOR,
            substeps: Substeps::Coarse,
        };
        let Some(fit) = problem.fit(candidate, 8).filter(|_| !still.is_empty()) else { continue };
        if best.as_ref().is_none_or(|best| fit.residual_counts[0] < best.residual_counts[0]) {
            best = Some(fit);
        }
        if best.as_ref().is_some_and(|best| best.residual_counts[0] < good) {
            break;
        }
    }
    best.map(|fit| fit.point).or(first).unwrap_or(point)
}

pub(crate) fn range(values: &[f64]) -> f64 {
    let [low, high] = values.iter().fold([0.0_f64; 2], |[low, high], it| [low.min(*it), high.max(*it)]);
    high - low
}

/// Sum of the logarithm of the motor's residuals against its range: a few samples far away don't decide. The load's
/// counts depend on the ratio, which is not known yet.
pub(crate) fn distance(motions: &[Motion], used: &[usize], point: &Point) -> f64 {
    let mut sum = 0.0;
    for &index in used {
        let (motion, own) = (&motions[index], &point.own[index]);
        let Some(predicted) = motion.predict(&point.vector, own, Substeps::Coarse) else {
            return f64::INFINITY;
        };
        let scale = 0.02 * range(&motion.counts[0]).max(1.0);
        for at in (0..motion.samples()).filter(|&at| motion.is_used[0][at]) {
            let residual = motion.counts[0][at] - predicted.counts[0][at];
            sum += (1.0 + (residual / scale).powi(2)).ln();
        }
    }
    sum
}
