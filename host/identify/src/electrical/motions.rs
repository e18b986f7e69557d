//! Motions of the electrical side, as currents over time.

use crate::excitation::REST_S;

/// Levels of a group, in holds: each direction has a step up and one down, in which the current keeps its sign, so the dead time takes
/// the same throughout. A free motor ends a group at rest, and a pair of groups where it began.
const GROUP: [f64; 6] = [0.5, 1.0, 0.5, -0.5, -1.0, -0.5];
/// Pairs of groups, as height and length: the ratio of charge to change of the current varies, which tells R from L.
const PAIRS: [(f64, f64); 5] = [(1.0, 1.0), (0.7, 1.3), (1.0, 0.7), (0.6, 1.0), (0.85, 0.85)];

/// Currents to be held one after the other, from rest.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldCurrents {
    /// Name, as of the record's folder.
    pub name: String,
    /// Commanded current of each step in A.
    pub current_a: Vec<f64>,
    /// Largest voltage that the bridge may make, in V; `None` for no limit of its own.
    pub largest_v: Option<f64>,
}

impl HeldCurrents {
    fn new(name: String, rest_s: f64, held: impl IntoIterator<Item = (f64, f64)>, period_s: f64) -> Self {
        let steps = |duration_s: f64| (duration_s / period_s).round().max(3.0) as usize;
        let rest = std::iter::once((0.0, rest_s));
        let held = rest.chain(held).chain([(0.0, REST_S)]);
        let current_a = held.flat_map(|(current_a, duration_s)| vec![current_a; steps(duration_s)]).collect();
        Self { name, current_a, largest_v: None }
    }
}

/// A hold in each direction whose voltage is limited to that of half its current: an open loop.
pub(super) fn polarity(
    index: usize,
    half_a: f64,
    resistance_ohm: f64,
    hold_s: f64,
    period_s: f64,
) -> HeldCurrents {
    let held = [1.0, 0.0, -1.0, 0.0].map(|sign| (sign * 2.0 * half_a, hold_s));
    let held = HeldCurrents::new(format!("electrical-polarity-{index}"), 0.0, held, period_s);
    HeldCurrents { largest_v: Some(half_a * resistance_ohm), ..held }
}

/// Groups of holds of up to `largest_a`, the shortest of which are 0.7 of `hold_s`, `rounds` times.
pub(super) fn groups(
    name: String,
    largest_a: f64,
    hold_s: f64,
    rounds: usize,
    period_s: f64,
) -> HeldCurrents {
    let mut held = Vec::new();
    for (height, length) in std::iter::repeat_n(PAIRS, rounds).flatten() {
        for sign in [1.0, -1.0] {
            held.extend(GROUP.map(|level| (sign * level * height * largest_a, length * hold_s)));
        }
    }
    HeldCurrents::new(name, REST_S + period_s, held, period_s)
}
