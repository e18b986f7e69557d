//! The load by the balance of momentum.

use nalgebra::{DMatrix, DVector};

use crate::parameters::{Parameter, Vector};
use crate::replay::Motion;

/// Inertia, viscous and Coulomb friction of the load by the balance of momentum over windows in which the load moves
/// one way: the work of the shaft's oscillations averages out.
pub(crate) fn balance(motions: &[Motion], vector: &mut Vector) {
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
