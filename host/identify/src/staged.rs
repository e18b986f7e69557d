//! First estimates, from which the fit starts: the balance of the torques gives motor, gap and shaft, then the load.

use crate::balance::balance;
use crate::breakaway::breakaway_nm;
use crate::cogging::Candidate;
use crate::free_body::free_body;
use crate::parameters::{Parameter, Vector};
use crate::problem::Point;
use crate::replay::{Motion, OwnParameters};

/// Logarithm of the load's stiction over its Coulomb friction, at least and at most.
const EXCESS: [f64; 2] = [0.02, 0.4];

/// What another count of the cogging per turn leaves of the torques' squares, over what the first one leaves, from which the first
/// one is sure.
const CLEAR: f64 = 1.5;

/// Where a fit begins.
pub(crate) struct Begin {
    pub(crate) point: Point,
    /// Counts of the cogging per turn, the likeliest first.
    pub(crate) cogging: Vec<Candidate>,
}

impl Begin {
    /// The counts per turn with the parts of a point first; those of the point alone if they are of another count.
    pub(crate) fn cogging_of(&self, point: &Point) -> Vec<Candidate> {
        let of_point = Candidate::of(point);
        match self.cogging.split_first() {
            Some((first, rest)) if first.per_turn == of_point.per_turn => {
                let first = Candidate { gain: first.gain, ..of_point };
                [&[first], rest].concat()
            }
            _ => vec![of_point],
        }
    }

    /// Whether one count of the cogging per turn leaves far less than any other.
    pub(crate) fn shows_cogging(&self) -> bool {
        let [first, second, ..] = &self.cogging[..] else { return false };
        second.gain < CLEAR * first.gain
    }
}

/// Starts of a fit, the likeliest first: taken from the motions as far as they show it, and the fallback as it is.
pub(crate) fn starts(motions: &[Motion], fallback: &Vector) -> Vec<Begin> {
    let own = vec![OwnParameters::default(); motions.len()];
    let given = Begin { point: Point { vector: *fallback, own }, cogging: Vec::new() };
    staged(motions, fallback).into_iter().chain([given]).collect()
}

fn staged(motions: &[Motion], fallback: &Vector) -> Option<Begin> {
    let body = free_body(motions, fallback.value(Parameter::Ratio))?;
    let mut vector = *fallback;
    body.put_on(&mut vector)?;
    balance(motions, &body, &mut vector);
    if let Some(torque_nm) = breakaway_nm(motions) {
        let excess = (torque_nm / vector.value(Parameter::LoadCoulomb)).ln();
        vector.set(Parameter::LoadExcess, excess.clamp(EXCESS[0], EXCESS[1]));
    }
    let own = |&twist_rad: &f64| OwnParameters { twist_rad, ..OwnParameters::default() };
    let own = body.twists_rad.iter().map(own).collect();
    Some(Begin { point: Point { vector, own }, cogging: body.cogging })
}
