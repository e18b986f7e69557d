//! The line of contact: where the torque is large the transmission is in contact, and the motor shows gap, stiffness and
//! friction, and with them where the load rests.
//!
//! ```text
//! theta_e = (U - F s) / K + j0 sgn U + b        s = sgn of the motor's velocity
//! ```
//!
//! until the load moves. It is linear in 1/K, F/K, j0 and the position b of the middle of the gap, one for each motion.

use nalgebra::{DMatrix, DVector};

use crate::parameters::{Parameter, Vector};
use crate::problem::Point;
use crate::replay::Motion;

/// Fraction of the breakaway torque above which the transmission counts as in contact.
pub(crate) const CONTACT: f64 = 0.2;
/// Load counts up to which the load counts as still at its first position.
const STILL_COUNTS: f64 = 1.0;
/// Time over which a velocity is formed.
const WINDOW_S: f64 = 0.02;
const ROUNDS: usize = 5;
const COMMON: usize = 3;

pub(crate) struct Line {
    /// 1 / K in rad/(N m).
    pub(crate) compliance: f64,
    /// F in N m.
    pub(crate) friction_nm: f64,
    pub(crate) half_gap_rad: f64,
    /// Motor position in the middle of the gap, for each motion, in rad.
    pub(crate) middles: Vec<f64>,
}

/// Least squares for the line, with less weight for samples far from it. `None` if it has no physical meaning.
pub(crate) fn contact_line(motions: &[Motion], contact_nm: f64) -> Option<Line> {
    let size = COMMON + motions.len();
    let mut rows: Vec<(Vec<f64>, f64)> = Vec::new();
    for (index, motion) in motions.iter().enumerate() {
        for at in 0..motion.samples() {
            if motion.counts[1][at].abs() > STILL_COUNTS {
                break;
            }
            let Some(shaft_nm) = steady_nm(motion, at, contact_nm, 1.0) else { continue };
            let torque_nm = motion.torque_nm[at];
            let side = torque_nm - shaft_nm;
            let mut row = vec![0.0; size];
            row[0] = torque_nm;
            row[1] = -side;
            row[2] = torque_nm.signum();
            row[COMMON + index] = 1.0;
            rows.push((row, motion.position_rad(0, at)));
        }
    }
    let mut weights = vec![1.0; rows.len()];
    let mut solution = DVector::zeros(size);
    for _ in 0..ROUNDS {
        let mut matrix = DMatrix::<f64>::zeros(size, size);
        let mut right = DVector::<f64>::zeros(size);
        for ((row, value), &weight) in rows.iter().zip(&weights) {
            for i in 0..size {
                right[i] += weight * row[i] * value;
                for j in 0..size {
                    matrix[(i, j)] += weight * row[i] * row[j];
                }
            }
        }
        for i in 0..size {
            matrix[(i, i)] += 1e-9;
        }
        solution = matrix.cholesky()?.solve(&right);
        let distances: Vec<f64> = rows
            .iter()
            .map(|(row, value)| {
                (value - row.iter().zip(solution.iter()).map(|(a, b)| a * b).sum::<f64>()).abs()
            })
            .collect();
        let mut sorted = distances.clone();
        sorted.sort_by(f64::total_cmp);
        let scale = 1.5 * sorted.get(sorted.len() / 2)?.max(1e-6);
        for (weight, distance) in weights.iter_mut().zip(&distances) {
            *weight = if *distance <= scale { 1.0 } else { scale / distance };
        }
    }
    let [compliance, friction, half_gap_rad] = [0, 1, 2].map(|at| solution[at]);
    if compliance.is_nan() || compliance <= 0.0 {
        return None;
    }
    Some(Line {
        compliance,
        friction_nm: (friction / compliance).clamp(1e-3 * contact_nm, contact_nm),
        half_gap_rad: half_gap_rad.max(2e-3),
        middles: solution.iter().skip(COMMON).copied().collect(),
    })
}

/// Mean torque at which the load leaves a rest, in N m at the motor. `None` if it never does.
pub(crate) fn breakaway_nm(motions: &[Motion]) -> Option<f64> {
    let mut found = Vec::new();
    for motion in motions {
        let rest = ((0.2 / motion.period_s) as usize).max(1);
        let load = &motion.counts[1];
        let mut since = 0;
        for at in 1..load.len() {
            if (load[at] - load[since]).abs() < 2.0 {
                continue;
            }
            if at - since > rest {
                found.push(motion.torque_nm[at - 1].abs());
            }
            since = at;
        }
    }
    found.sort_by(f64::total_cmp);
    found.get(found.len() / 2).copied()
}

/// Whether the transmission is in contact at a sample and the motor doesn't accelerate. Gives the torque at the shaft.
fn steady_nm(motion: &Motion, at: usize, contact_nm: f64, friction_nm: f64) -> Option<f64> {
    let window = window(motion);
    if at < window || at + window >= motion.samples() {
        return None;
    }
    let torque_nm = motion.torque_nm[at];
    let around = [at - window, at, at + window].map(|at| motion.counts[0][at]);
    let bend = (around[2] - 2.0 * around[1] + around[0]).abs();
    if torque_nm.abs() < contact_nm || bend > motion.steady_counts {
        return None;
    }
    let moved = around[2] - around[0];
    let side = if moved.abs() >= 3.0 { moved.signum() } else { 0.0 };
    Some(torque_nm - friction_nm * side)
}

fn window(motion: &Motion) -> usize {
    ((WINDOW_S / motion.period_s) as usize).max(1)
}

/// Twist of a contact that carries a torque.
fn contact_rad(vector: &Vector, torque_nm: f64) -> f64 {
    torque_nm / vector.value(Parameter::Stiffness) + vector.value(Parameter::DeadZone) * torque_nm.signum()
}

/// Twist at the first sample, from the samples before the load moves.
pub(crate) fn twist_rad(motion: &Motion, vector: &Vector, contact_nm: f64) -> Option<f64> {
    let friction_nm = vector.value(Parameter::MotorCoulomb);
    let mut found: Vec<f64> = (0..motion.samples())
        .take_while(|&at| motion.counts[1][at].abs() <= STILL_COUNTS)
        .filter_map(|at| {
            let torque_nm = steady_nm(motion, at, contact_nm, friction_nm)?;
            Some(contact_rad(vector, torque_nm) - motion.position_rad(0, at))
        })
        .collect();
    found.sort_by(f64::total_cmp);
    found.get(found.len() / 2).copied()
}

/// Reduction ratio, from steady samples at which the load rests elsewhere.
pub(crate) fn ratio(motions: &[Motion], point: &Point, contact_nm: f64) -> Option<f64> {
    let friction_nm = point.vector.value(Parameter::MotorCoulomb);
    let [mut product, mut square] = [0.0; 2];
    for (motion, own) in motions.iter().zip(&point.own) {
        let window = window(motion);
        for at in window..motion.samples().saturating_sub(window) {
            let load = &motion.counts[1];
            if (load[at + window] - load[at - window]).abs() > 1.0 {
                continue;
            }
            let Some(torque_nm) = steady_nm(motion, at, contact_nm, friction_nm) else { continue };
            let load_rad = motion.position_rad(1, at);
            let motor_rad =
                motion.position_rad(0, at) + own.twist_rad - contact_rad(&point.vector, torque_nm);
            product += load_rad * motor_rad;
            square += load_rad * load_rad;
        }
    }
    (product > 0.0).then(|| product / square)
}
