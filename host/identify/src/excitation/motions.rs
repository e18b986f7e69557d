//! The motions of a commissioning as torques over time. Every one begins and ends without torque, or under the one that
//! holds the drive train.

use super::limits::REST_S;
use crate::series::{Held, Series};

/// Duration of a ramp until the torque limit, in s.
const RAMP_S: f64 = 3.0;
/// The ramp begins at this fraction of the torque limit.
const RAMP_FROM: f64 = 1e-3;

/// Torque of every sample, in N m, and the name of the motion.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedMotion {
    /// Name, as of the record's folder.
    pub name: String,
    /// Torque of each sample in N m.
    pub torque_nm: Vec<f64>,
    /// Largest twist by the counts of both encoders that the motion explains, for any directions and any reduction
    /// ratio, in rad at the motor. `None` while nothing is known of the drive train.
    pub twist_rad: Option<f64>,
    /// How it begins if an offset moves the drive train; `None` for one that rests without torque.
    pub held: Option<Held>,
}

impl PlannedMotion {
    /// A motion that begins with the time at rest.
    fn from_rest(name: String, torque_nm: impl IntoIterator<Item = f64>, period_s: f64) -> Self {
        let rest = std::iter::repeat_n(0.0, (REST_S / period_s).ceil() as usize);
        Self { name, torque_nm: rest.chain(torque_nm).collect(), twist_rad: None, held: None }
    }
}

/// Torques to breakaway each way, at the motor.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Breakaway {
    /// Forward, in N m.
    pub forward_nm: f64,
    /// Backward, in N m, without its sign.
    pub backward_nm: f64,
}

impl Breakaway {
    fn along(&self, fraction: f64) -> f64 {
        fraction * if fraction < 0.0 { self.backward_nm } else { self.forward_nm }
    }
}

/// A torque that rises by equal factors up to the limit, so that it is slow for a large and a small drive alike.
pub(super) fn ramp(limit_nm: f64, sign: f64, period_s: f64) -> PlannedMotion {
    let samples = (RAMP_S / period_s).round() as usize;
    let torque = |at: usize| sign * limit_nm * RAMP_FROM.powf(1.0 - (at + 1) as f64 / samples as f64);
    let name = if sign < 0.0 { "breakaway-backward" } else { "breakaway-forward" };
    PlannedMotion::from_rest(name.to_owned(), (0..samples).map(torque), period_s)
}

/// A constant torque from wherever the drive train is. The first is 0.
pub(super) fn held(torque_nm: f64, number: u32, duration_s: f64, period_s: f64) -> PlannedMotion {
    let samples = ((duration_s / period_s).ceil() as usize).max(Series::SAMPLES_MIN);
    let name = format!("rest-{number}");
    PlannedMotion { name, torque_nm: vec![torque_nm; samples], twist_rad: None, held: None }
}

/// A reversal within breakaway, then one beyond it. Half cosines leave the motor's swing on the shaft small.
pub(super) fn slow_reversal(breakaway: &Breakaway, period_s: f64) -> PlannedMotion {
    const RATE_1_S: f64 = 2.0;
    const CORNERS: [f64; 5] = [0.7, -0.7, 1.15, -1.15, 0.0];
    let mut torque_nm = Vec::new();
    let mut from = 0.0_f64;
    for to in CORNERS {
        let samples = ((to - from).abs() / RATE_1_S / period_s).ceil() as usize;
        torque_nm.extend((1..=samples).map(|at| {
            let turn = core::f64::consts::PI * at as f64 / samples as f64;
            breakaway.along(from + (to - from) * 0.5 * (1.0 - turn.cos()))
        }));
        from = to;
    }
    PlannedMotion::from_rest("slow-reversal".to_owned(), torque_nm, period_s)
}

/// Steps within breakaway: the motor crosses the gap and swings on the shaft, the load stays at rest.
pub(super) fn steps(breakaway: &Breakaway, period_s: f64) -> PlannedMotion {
    const STEPS: [(f64, f64); 4] = [(0.5, 0.3), (-0.5, 0.3), (0.5, 0.3), (0.0, 0.3)];
    let held = STEPS.map(|(fraction, duration_s)| (breakaway.along(fraction), duration_s));
    PlannedMotion::from_rest("steps".to_owned(), hold(&held, period_s), period_s)
}

/// Pulses beyond breakaway, there and back: the load accelerates and friction stops it.
pub(super) fn pulses(breakaway: &Breakaway, pulse: &Pulse, index: usize, period_s: f64) -> PlannedMotion {
    const STOP_S: f64 = 0.3;
    const FLANK_S: f64 = 0.15;
    const HOLD: f64 = 0.3;
    const EDGE_S: f64 = 0.1;
    // Both flanks first: they show where in the gap the motion begins. Between pulses a torque within breakaway keeps the
    // flank closed, so that the rests show the reduction ratio.
    let hold_nm = |sign: f64| breakaway.along(HOLD * sign);
    let mut held = vec![(hold_nm(1.0), FLANK_S), (hold_nm(-1.0), FLANK_S)];
    for sign in [1.0, -1.0, -1.0, 1.0] {
        held.extend([(breakaway.along(sign * pulse.breakaways), pulse.duration_s), (hold_nm(sign), STOP_S)]);
    }
    held.push((0.0, 0.1));
    let mut torque_nm = hold(&held, period_s);
    smooth(&mut torque_nm, (EDGE_S / period_s).round() as usize);
    PlannedMotion::from_rest(format!("pulses-{index}"), torque_nm, period_s)
}

/// Height and duration of a pulse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pulse {
    /// Torque in breakaway torques.
    pub(super) breakaways: f64,
    pub(super) duration_s: f64,
}

impl Pulse {
    /// The next pulse: so much longer and higher that the load moves about three times as far, up to twice as fast.
    pub(super) fn grown(self) -> Self {
        const FACTOR: f64 = 1.25;
        const LONGEST_S: f64 = 0.4;
        let duration_s = (self.duration_s * FACTOR).min(LONGEST_S);
        Self { breakaways: self.breakaways * FACTOR, duration_s }
    }
}

fn hold(held: &[(f64, f64)], period_s: f64) -> Vec<f64> {
    let samples = |duration_s: f64| (duration_s / period_s).round().max(1.0) as usize;
    held.iter()
        .flat_map(|&(torque_nm, duration_s)| std::iter::repeat_n(torque_nm, samples(duration_s)))
        .collect()
}

/// Makes every edge a straight one of this length: the motor swings less on the shaft.
fn smooth(torque_nm: &mut [f64], samples: usize) {
    let steep = torque_nm.to_vec();
    let mut sum = 0.0;
    for (at, smooth) in torque_nm.iter_mut().enumerate() {
        sum += steep[at] - if at >= samples { steep[at - samples] } else { 0.0 };
        *smooth = sum / samples.max(1) as f64;
    }
}
