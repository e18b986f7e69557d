//! First estimates, from which the fit starts.
//!
//! Where the torque is large the transmission is in contact, and on average over its oscillations
//!
//! ```text
//! theta_e = (U - F s) / K + j0 sgn U + b        s = sgn of the motor's velocity
//! ```
//!
//! until the load moves. It is linear in 1/K, F/K, j0 and the position b of the middle of the gap, one for each motion. The
//! load breaks away at its stiction. What is left, inertias above all, comes from a search over factors.

use nalgebra::{DMatrix, DVector};

use crate::fit::{Fit, OwnParameters, Point, Problem};
use crate::parameters::{COUNT, Parameter, Vector};
use crate::replay::{Motion, Substeps};

/// Fraction of the breakaway torque above which the transmission counts as in contact.
const CONTACT: f64 = 0.2;
/// Load counts up to which the load counts as still at its first position.
const STILL_COUNTS: f64 = 1.0;
/// Time over which a velocity is formed.
const WINDOW_S: f64 = 0.02;
const ROUNDS: usize = 5;
const COMMON: usize = 3;

/// Starts of a fit, the likeliest first: taken from the motions as far as they show it, and the fallback as it is.
pub(crate) fn starts(motions: &[Motion], fallback: &Vector) -> [Point; 2] {
    let staged = staged(motions, fallback);
    let own = vec![OwnParameters::default(); motions.len()];
    let given = Point { vector: *fallback, own };
    let all: Vec<_> = (0..motions.len()).collect();
    if distance(motions, &all, &given) < distance(motions, &all, &staged) {
        [given, staged]
    } else {
        [staged, given]
    }
}

fn staged(motions: &[Motion], fallback: &Vector) -> Point {
    let mut vector = *fallback;
    let mut own = vec![OwnParameters::default(); motions.len()];
    let breakaway_nm = breakaway_nm(motions);
    let peaks = motions.iter().map(|it| it.torque_nm.iter().fold(0.0_f64, |peak, it| peak.max(it.abs())));
    let contact_nm = CONTACT * breakaway_nm.unwrap_or_else(|| peaks.fold(f64::MAX, f64::min));
    if let Some(line) = contact_line(motions, contact_nm) {
        let Line { compliance, friction, half_gap_rad, middles } = line;
        vector.set(Parameter::Stiffness, -compliance.ln());
        vector.set(Parameter::MotorCoulomb, friction.ln());
        vector.set(Parameter::DeadZone, half_gap_rad.ln());
        vector.set(Parameter::MotorExcess, 0.1);
        for (own, middle_rad) in own.iter_mut().zip(middles) {
            own.twist_rad = -middle_rad;
        }
    }
    if let Some(torque_nm) = breakaway_nm {
        let friction_nm = vector.value(Parameter::MotorCoulomb);
        vector.set(Parameter::LoadCoulomb, (0.85 * (torque_nm - friction_nm).max(0.3 * torque_nm)).ln());
        vector.set(Parameter::LoadExcess, 0.1);
    }
    let travel = |it: &Motion| range(&it.counts[1]);
    let longest = motions.iter().map(travel).fold(0.0, f64::max);
    let is_still: Vec<bool> = motions.iter().map(|it| travel(it) < STILL * longest).collect();
    let some = |wanted: bool| (0..motions.len()).filter(|&at| is_still[at] == wanted).collect::<Vec<_>>();
    let mut point = motor(motions, &some(true), Point { vector, own });
    let moving = some(false);
    for &index in &moving {
        if let Some(twist_rad) = twist_rad(&motions[index], &point.vector, contact_nm) {
            point.own[index].twist_rad = twist_rad;
        }
    }
    if let Some(ratio) = ratio(motions, &point, contact_nm) {
        point.vector.set(Parameter::Ratio, ratio.ln());
    }
    balance(motions, &mut point.vector);
    if !moving.is_empty() {
        let problem =
            Problem { motions, used: moving, start: point.vector, is_free: LOAD, substeps: Substeps::Coarse };
        if let Some(fit) = problem.fit(point.clone(), 6) {
            point = fit.point;
        }
    }
    point
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
fn twist_rad(motion: &Motion, vector: &Vector, contact_nm: f64) -> Option<f64> {
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
fn ratio(motions: &[Motion], point: &Point, contact_nm: f64) -> Option<f64> {
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

/// Inertia, viscous and Coulomb friction of the load by the balance of momentum over windows in which the load moves
/// one way: the work of the shaft's oscillations averages out.
fn balance(motions: &[Motion], vector: &mut Vector) {
    const WINDOW_S: f64 = 0.1;
    let ratio = vector.value(Parameter::Ratio);
    let friction_nm = vector.value(Parameter::MotorCoulomb);
    let inertia = vector.value(Parameter::MotorInertia);
    let mut matrix = DMatrix::<f64>::zeros(3, 3);
    let mut right = DVector::<f64>::zeros(3);
    for motion in motions {
        let window = ((WINDOW_S / motion.period_s) as usize).max(4);
        let slope = window / 4;
        let speed = |encoder: usize, at: usize| {
            let moved = motion.position_rad(encoder, at + slope) - motion.position_rad(encoder, at - slope);
            moved / (2 * slope) as f64 / motion.period_s
        };
        for from in (slope..motion.samples().saturating_sub(window + slope)).step_by(slope.max(1)) {
            let until = from + window;
            let counts = &motion.counts[1];
            let speeds = [from, from + window / 2, until].map(|at| speed(1, at));
            let side = speeds[1].signum();
            if speeds.iter().any(|it| it * side <= 0.0) || (counts[until] - counts[from]).abs() < 8.0 {
                continue;
            }
            let duration_s = window as f64 * motion.period_s;
            let impulse = motion.torque_nm[from..until].iter().sum::<f64>() * motion.period_s;
            let motor = inertia * (speed(0, until) - speed(0, from)) + friction_nm * side * duration_s;
            let row = [
                ratio * (speeds[2] - speeds[0]),
                ratio * (motion.position_rad(1, until) - motion.position_rad(1, from)),
                side * duration_s,
            ];
            for i in 0..3 {
                right[i] += row[i] * (impulse - motor);
                for j in 0..3 {
                    matrix[(i, j)] += row[i] * row[j];
                }
            }
        }
    }
    let Some(solution) = matrix.cholesky().map(|it| it.solve(&right)) else { return };
    let breakaway_nm = vector.value(Parameter::LoadCoulomb);
    if solution[0] > 0.0 {
        vector.set(Parameter::LoadInertia, solution[0].ln());
    }
    if solution[1] > 0.0 {
        vector.set(Parameter::LoadViscous, solution[1].ln());
    }
    if solution[2] > 0.3 * breakaway_nm && solution[2] < 1.2 * breakaway_nm {
        vector.set(Parameter::LoadCoulomb, solution[2].ln());
    }
}

/// What motions of the load show once the motor is known.
const LOAD: [bool; COUNT] = {
    let mut free = [false; COUNT];
    free[Parameter::LoadInertia as usize] = true;
    free[Parameter::LoadViscous as usize] = true;
    free[Parameter::LoadCoulomb as usize] = true;
    free[Parameter::LoadExcess as usize] = true;
    free[Parameter::LoadAsymmetry as usize] = true;
    free[Parameter::Ratio as usize] = true;
    free
};

/// Fraction of the longest travel of the load below which a motion is one of the motor alone.
const STILL: f64 = 0.25;

/// What a motion of the motor alone shows.
const MOTOR: [bool; COUNT] = {
    let mut free = [false; COUNT];
    free[Parameter::MotorInertia as usize] = true;
    free[Parameter::MotorCoulomb as usize] = true;
    free[Parameter::MotorExcess as usize] = true;
    free[Parameter::Stiffness as usize] = true;
    free[Parameter::DeadZone as usize] = true;
    free[Parameter::ShaftDamping as usize] = true;
    free
};

fn range(values: &[f64]) -> f64 {
    let [low, high] = values.iter().fold([0.0_f64; 2], |[low, high], it| [low.min(*it), high.max(*it)]);
    high - low
}

struct Line {
    compliance: f64,
    friction: f64,
    half_gap_rad: f64,
    /// Motor position in the middle of the gap, for each motion, in rad.
    middles: Vec<f64>,
}

/// Least squares for the line, with less weight for samples far from it. `None` if it has no physical meaning.
fn contact_line(motions: &[Motion], contact_nm: f64) -> Option<Line> {
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
    if !(compliance > 0.0) {
        return None;
    }
    Some(Line {
        compliance,
        friction: (friction / compliance).clamp(1e-3 * contact_nm, contact_nm),
        half_gap_rad: half_gap_rad.max(2e-3),
        middles: solution.iter().skip(COMMON).copied().collect(),
    })
}

/// Mean torque at which the load leaves a rest, in N m at the motor. `None` if it never does.
fn breakaway_nm(motions: &[Motion]) -> Option<f64> {
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

/// Range of the search for the motor's inertia around the start, as a logarithm, and its steps.
const SEARCH: f64 = 4.2;
const SEARCH_STEPS: i32 = 9;
/// Inertias that a fit is started from, at most.
const CANDIDATES: usize = 4;
/// Residual of a fit that needs no other candidate, as a fraction of the motor's range.
const GOOD: f64 = 0.01;

/// Fits the motor to the motions of the motor alone. The inertia is first searched for, with a shaft damped by 5 % of
/// critical.
fn motor(motions: &[Motion], still: &[usize], point: Point) -> Point {
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

/// Sum of the logarithm of the motor's residuals against its range: a few samples far away don't decide. The load's
/// counts depend on the ratio, which is not known yet.
fn distance(motions: &[Motion], used: &[usize], point: &Point) -> f64 {
    let mut sum = 0.0;
    for &index in used {
        let (motion, own) = (&motions[index], &point.own[index]);
        let Some(predicted) = motion.predict(&point.vector, own.twist_rad, Substeps::Coarse) else {
            return f64::INFINITY;
        };
        let scale = 0.02 * range(&motion.counts[0]).max(1.0);
        for at in (0..motion.samples()).filter(|&at| motion.is_used[0][at]) {
            let residual = motion.counts[0][at] - predicted[0][at];
            sum += (1.0 + (residual / scale).powi(2)).ln();
        }
    }
    sum
}
