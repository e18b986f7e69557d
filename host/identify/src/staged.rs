//! First estimates, from which the fit starts.
//!
//! The line of contact gives gap, stiffness and friction, the motions of the motor alone its inertia, rests at other
//! positions the ratio, the balance of momentum the load. The load breaks away at its stiction.

use crate::balance::balance;
use crate::contact::{CONTACT, Line, breakaway_nm, contact_line, ratio, twist_rad};
use crate::motor::{distance, motor, range};
use crate::parameters::{COUNT, Parameter, Vector};
use crate::prior::Prior;
use crate::problem::{Point, Problem};
use crate::replay::{Motion, OwnParameters, Substeps};

/// Fraction of the longest travel of the load below which a motion is one of the motor alone.
const STILL: f64 = 0.25;

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

/// Starts of a fit, the likeliest first: taken from the motions as far as they show it, and the fallback as it is.
pub(crate) fn starts(motions: &[Motion], fallback: &Vector, prior: &Prior) -> [Point; 2] {
    let staged = staged(motions, fallback, prior);
    let own = vec![OwnParameters::default(); motions.len()];
    let given = Point { vector: *fallback, own };
    let all: Vec<_> = (0..motions.len()).collect();
    if distance(motions, &all, &given) < distance(motions, &all, &staged) {
        [given, staged]
    } else {
        [staged, given]
    }
}

fn staged(motions: &[Motion], fallback: &Vector, prior: &Prior) -> Point {
    let mut vector = *fallback;
    let mut own = vec![OwnParameters::default(); motions.len()];
    let breakaway_nm = breakaway_nm(motions);
    let peaks = motions.iter().map(|it| it.torque_nm.iter().fold(0.0_f64, |peak, it| peak.max(it.abs())));
    let contact_nm = CONTACT * breakaway_nm.unwrap_or_else(|| peaks.fold(f64::MAX, f64::min));
    if let Some(line) = contact_line(motions, contact_nm) {
        let Line { compliance, friction_nm, half_gap_rad, middles } = line;
        vector.set(Parameter::Stiffness, -compliance.ln());
        vector.set(Parameter::MotorCoulomb, friction_nm.ln());
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
    let mut point = motor(motions, &some(true), Point { vector, own }, prior);
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
        let problem = Problem {
            motions,
            used: moving,
            start: point.vector,
            prior: *prior,
            is_free: LOAD,
            substeps: Substeps::Coarse,
        };
        if let Some(fit) = problem.fit(point.clone(), 6) {
            point = fit.point;
        }
    }
    point
}
