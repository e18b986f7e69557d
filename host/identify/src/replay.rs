//! A recorded motion as the fit sees it, and the same torques on the plant model.

use lashloop_plant::{RunningPlant, Start, TransportDelay};

use crate::parameters::Vector;
use crate::series::{Instruments, Series};
use crate::signs::Direction;

/// Integration steps per control period.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Substeps {
    /// On the way to an estimate.
    Coarse = 2,
    /// For the estimate: the error stays far below a count.
    Fine = 4,
}

/// Time in which samples of an encoder at rest still count. Later ones repeat what the first ones show.
const REST_S: f64 = 0.02;

/// One motion, counts in their direction from the first sample on, torques as they arrive at the motor.
pub(crate) struct Motion {
    pub(crate) period_s: f64,
    held: Held,
    /// The torques as errors of the instruments would have altered them, each by one standard deviation over the root of
    /// the number of its kind.
    pub(crate) altered: Vec<Altered>,
    pub(crate) torque_nm: Vec<f64>,
    /// Counts of motor and load since the first sample.
    pub(crate) counts: [Vec<f64>; 2],
    /// Whether a sample of an encoder counts.
    pub(crate) is_used: [Vec<bool>; 2],
    pub(crate) counts_per_rad: [f64; 2],
    /// Change of the motor's motion from one window to the next up to which the motor counts as steady.
    pub(crate) steady_counts: f64,
}

/// Torques held one after the other within each period, in N m, with their duration in s.
pub(crate) type Held = Vec<Vec<(f64, f64)>>;

/// Torques that an error of the instruments has altered.
pub(crate) struct Altered {
    pub(crate) held: Held,
    /// Weight of the difference that they make.
    pub(crate) scale: f64,
}

/// Counts of motor and load that a model predicts, from the first sample on.
pub(crate) type Prediction = [Vec<f64>; 2];

impl Motion {
    pub(crate) fn new(series: &Series, instruments: &Instruments, directions: [Direction; 2]) -> Self {
        let readings = [series.motor_counts(), series.load_counts()];
        let counts = [0, 1].map(|at| {
            let (readings, sign) = (readings[at], directions[at].sign());
            readings.iter().map(|count| ((count - readings[0]) * sign) as f64).collect::<Vec<_>>()
        });
        let rest = (REST_S / series.period_s()).ceil() as usize;
        let is_used = [0, 1].map(|at| used(&counts[at], rest.max(2)));
        let [low, high] =
            counts[0].iter().fold([0.0_f64; 2], |[low, high], it| [low.min(*it), high.max(*it)]);
        Self {
            steady_counts: (5e-3 * (high - low)).max(2.0),
            period_s: series.period_s(),
            held: held(series, instruments.torque_delay_us, |torque_nm| torque_nm),
            altered: altered(series, instruments),
            torque_nm: series.torque_nm().to_vec(),
            counts,
            is_used,
            counts_per_rad: [instruments.motor_counts_per_rad(), instruments.load_counts_per_rad()],
        }
    }

    pub(crate) fn samples(&self) -> usize {
        self.torque_nm.len()
    }

    /// Motor and load position since the first sample, in rad.
    pub(crate) fn position_rad(&self, encoder: usize, sample: usize) -> f64 {
        self.counts[encoder][sample] / self.counts_per_rad[encoder]
    }

    /// The counts of the plant model under the recorded torques, released at rest with a twist of `twist_rad` against
    /// the middle of its gap. `None` if the model can't be followed.
    pub(crate) fn predict(&self, vector: &Vector, twist_rad: f64, substeps: Substeps) -> Option<Prediction> {
        self.predict_under(&self.held, vector, twist_rad, substeps)
    }

    /// As [`predict`](Self::predict), under other torques.
    pub(crate) fn predict_under(
        &self,
        held: &Held,
        vector: &Vector,
        twist_rad: f64,
        substeps: Substeps,
    ) -> Option<Prediction> {
        let plant = vector.plant(substeps as u32).ok()?;
        let mut plant = RunningPlant::released(plant, Start::at_rest(0.0, twist_rad));
        let mut predicted = [0, 1].map(|_| Vec::with_capacity(self.samples()));
        for held in held {
            let positions = lashloop_plant::Plant::positions(&plant);
            predicted[0].push((positions.motor_position_rad - twist_rad) * self.counts_per_rad[0]);
            predicted[1].push(positions.load_position_rad * self.counts_per_rad[1]);
            for &(torque_nm, held_s) in held {
                plant.step(torque_nm, held_s).ok()?;
            }
        }
        Some(predicted)
    }
}

/// Torques as the motor gets them under the errors of a quantising power stage and of an uncertain delay.
fn altered(series: &Series, instruments: &Instruments) -> Vec<Altered> {
    /// Places of the torque within a step: a power stage rounds, and where it rounds to is not known.
    const PLACES: u32 = 8;
    let Instruments { torque_delay_us, torque_delay_deviation_us, torque_step_nm: step_nm, .. } =
        *instruments;
    let mut altered = Vec::new();
    if torque_delay_deviation_us > 0 {
        let held = held(series, torque_delay_us + torque_delay_deviation_us, |torque_nm| torque_nm);
        altered.push(Altered { held, scale: 1.0 });
    }
    if step_nm > 0.0 {
        altered.extend((0..PLACES).map(|place| {
            let shift_nm = step_nm * ((f64::from(place) + 0.5) / f64::from(PLACES) - 0.5);
            let rounded = |torque_nm: f64| match torque_nm {
                // The power stage has a duty for it.
                0.0 => 0.0,
                torque_nm => ((torque_nm + shift_nm) / step_nm).round() * step_nm - shift_nm,
            };
            Altered { held: held(series, torque_delay_us, rounded), scale: f64::from(PLACES).sqrt().recip() }
        }));
    }
    altered
}

fn held(series: &Series, delay_us: u32, torque_nm: impl Fn(f64) -> f64) -> Held {
    let mut delay = TransportDelay::new(delay_us, series.period_us());
    series.torque_nm().iter().map(|&commanded_nm| delay.step(torque_nm(commanded_nm)).collect()).collect()
}

/// The samples within `rest` samples after a change of the count, and as many before one.
fn used(counts: &[f64], rest: usize) -> Vec<bool> {
    let mut used = vec![false; counts.len()];
    let mut mark = |from: usize, until: usize| {
        let until = until.min(counts.len());
        used[from.min(until)..until].fill(true);
    };
    mark(0, rest);
    for at in (1..counts.len()).filter(|&at| counts[at] != counts[at - 1]) {
        mark(at.saturating_sub(rest), at + rest);
    }
    used
}
