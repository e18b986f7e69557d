//! A recorded motion as the fit sees it, and the same torques on the plant model.

use lashloop_plant::{RunningPlant, Start, TransportDelay};

use crate::parameters::{Parameter, Vector};
use crate::series::{Instruments, Series};
use crate::signs::Direction;

/// How a motion is integrated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Substeps {
    /// On the way to an estimate. The cogging is that at the recorded angles.
    Coarse,
    /// The same in smaller steps, for the estimate where the model's own cogging would hold it in other dents than the motor's.
    Recorded,
    /// For the estimate: the error stays far below a count.
    Fine,
    /// The same for a motor that passes many periods of the cogging within a control period.
    Finest,
}

impl Substeps {
    /// Whether the cogging is that at the recorded angles.
    fn is_at_recorded(self) -> bool {
        matches!(self, Self::Coarse | Self::Recorded)
    }

    /// Integration steps per control period.
    fn number(self) -> u32 {
        match self {
            Self::Coarse => 2,
            Self::Recorded | Self::Fine => 4,
            Self::Finest => 16,
        }
    }
}

/// Time in which samples of an encoder at rest still count. Later ones repeat what the first ones show.
const REST_S: f64 = 0.02;

/// Standard deviation of an encoder's offset within its count.
const OFFSET_DEVIATION: f64 = 0.4;

/// One motion, counts in their direction from the first sample on, torques as they arrive at the motor.
pub(crate) struct Motion {
    pub(crate) period_s: f64,
    held: Held,
    /// The torques as errors of the instruments would have altered them, each by one standard deviation over the root of
    /// the number of its kind.
    pub(crate) altered: Vec<Altered>,
    pub(crate) torque_nm: Vec<f64>,
    /// Torque that holds the drive train before the first sample.
    pub(crate) held_nm: f64,
    /// Counts of motor and load since the first sample.
    pub(crate) counts: [Vec<f64>; 2],
    /// Whether a sample of an encoder counts.
    pub(crate) is_used: [Vec<bool>; 2],
    pub(crate) counts_per_rad: [f64; 2],
    /// Counts of the motor without most of the noise.
    smooth_counts: Vec<f64>,
    /// Reading of both encoders at the first sample, in their direction.
    first_counts: [f64; 2],
    /// Amplitude of the noise of both encoders, in counts.
    pub(crate) noise_counts: f64,
    /// Standard deviation of an encoder's offset from its first reading, in counts.
    pub(crate) offset_deviation: f64,
}

/// Torques held one after the other within each period, in N m, with their duration in s.
pub(crate) type Held = Vec<Vec<(f64, f64)>>;

/// Torques that an error of the instruments has altered.
pub(crate) struct Altered {
    pub(crate) held: Held,
    /// Weight of the difference that they make.
    pub(crate) scale: f64,
}

/// What is of one motion alone: the twist at its first sample, and where within their first count both encoders stood.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct OwnParameters {
    pub(crate) twist_rad: f64,
    pub(crate) offsets: [f64; 2],
}

/// What a model predicts of motor and load, from the first sample on.
#[derive(Clone)]
pub(crate) struct Prediction {
    /// How far the shafts have turned.
    turned_rad: [Vec<f64>; 2],
    /// What the encoders show.
    pub(crate) counts: [Vec<f64>; 2],
}

impl Motion {
    pub(crate) fn new(series: &Series, instruments: &Instruments, directions: [Direction; 2]) -> Self {
        let readings = [series.motor_counts(), series.load_counts()];
        let counts = [0, 1].map(|at| {
            let (readings, sign) = (readings[at], directions[at].sign());
            readings.iter().map(|count| ((count - readings[0]) * sign) as f64).collect::<Vec<_>>()
        });
        let rest = (REST_S / series.period_s()).ceil() as usize;
        let is_used = [0, 1].map(|at| used(&counts[at], rest.max(2)));
        let counts_per_rad = [instruments.motor_counts_per_rad(), instruments.load_counts_per_rad()];
        let first_counts = [0, 1].map(|at| (readings[at][0] * directions[at].sign()) as f64);
        Self {
            period_s: series.period_s(),
            held: held(series, instruments.torque_delay_us, |torque_nm| torque_nm),
            altered: altered(series, instruments),
            torque_nm: series.torque_nm().to_vec(),
            held_nm: series.held_nm(),
            smooth_counts: smoothed(&counts[0]),
            counts,
            is_used,
            counts_per_rad,
            noise_counts: instruments.noise_counts,
            offset_deviation: OFFSET_DEVIATION.hypot(instruments.noise_counts),
            first_counts,
        }
    }

    pub(crate) fn samples(&self) -> usize {
        self.torque_nm.len()
    }

    /// Motor and load position since the first sample, in rad.
    pub(crate) fn position_rad(&self, encoder: usize, sample: usize) -> f64 {
        self.counts[encoder][sample] / self.counts_per_rad[encoder]
    }

    /// The torque that arrives at the motor, as the mean of the periods before and after each sample, in N m.
    pub(crate) fn arriving_nm(&self) -> Vec<f64> {
        let mean = |held: &Vec<(f64, f64)>| {
            held.iter().map(|(torque_nm, held_s)| torque_nm * held_s).sum::<f64>() / self.period_s
        };
        let held: Vec<f64> = self.held.iter().map(mean).collect();
        (0..held.len()).map(|at| 0.5 * (held[at.saturating_sub(1)] + held[at])).collect()
    }

    /// The motor's angle by its own encoder at a sample, from the encoder's zero.
    pub(crate) fn shown_rad(&self, sample: usize) -> f64 {
        (self.first_counts[0] + self.counts[0][sample]) / self.counts_per_rad[0]
    }

    /// The counts of the plant model under the recorded torques, released at rest with a twist against the middle of
    /// its gap. `None` if the model can't be followed.
    pub(crate) fn predict(
        &self,
        vector: &Vector,
        own: &OwnParameters,
        substeps: Substeps,
    ) -> Option<Prediction> {
        self.predict_under(&self.held, vector, own, substeps)
    }

    /// As [`predict`](Self::predict), under other torques.
    pub(crate) fn predict_under(
        &self,
        held: &Held,
        vector: &Vector,
        own: &OwnParameters,
        substeps: Substeps,
    ) -> Option<Prediction> {
        let turned_rad = self.turned_rad(held, vector, own, substeps)?;
        Some(self.shown(vector, own, turned_rad))
    }

    /// The same motion, as encoders of another eccentricity show it.
    pub(crate) fn reread(&self, prediction: &Prediction, vector: &Vector, own: &OwnParameters) -> Prediction {
        self.shown(vector, own, prediction.turned_rad.clone())
    }

    fn turned_rad(
        &self,
        held: &Held,
        vector: &Vector,
        own: &OwnParameters,
        substeps: Substeps,
    ) -> Option<[Vec<f64>; 2]> {
        let [cosine_nm, sine_nm] = Parameter::COGGING.map(|it| vector.get(it));
        let (cogging_nm, phase_rad) = (cosine_nm.hypot(sine_nm), cosine_nm.atan2(sine_nm));
        let has_cogging = cogging_nm != 0.0;
        let per_turn = f64::from(vector.cogging_per_turn);
        let at_recorded = substeps.is_at_recorded() && has_cogging;
        let plant = if at_recorded { vector.smooth() } else { *vector };
        // Where the plant's own cogging, a sine of the motor's angle, has this phase.
        let motor_rad = self.first_rad(vector, own, 0) + phase_rad / per_turn;
        let load_rad = (motor_rad - own.twist_rad) / vector.value(Parameter::Ratio);
        let steps = substeps.number();
        // The cogging at the recorded angles changes with every step.
        let parts = if at_recorded { steps } else { 1 };
        let plant = plant.plant(steps.div_ceil(parts)).ok()?;
        let start = Start::at_rest(load_rad, motor_rad);
        let mut plant = if self.held_nm == 0.0 {
            RunningPlant::released(plant, start)
        } else {
            plant.released_under(start, self.held_nm)
        };
        let mut turned_rad = [0, 1].map(|_| Vec::with_capacity(self.samples()));
        for (at, held) in held.iter().enumerate() {
            let positions = lashloop_plant::Plant::positions(&plant);
            turned_rad[0].push(positions.motor_position_rad - motor_rad);
            turned_rad[1].push(positions.load_position_rad - load_rad);
            let mut elapsed_s = 0.0;
            for &(torque_nm, held_s) in held {
                let part_s = held_s / f64::from(parts);
                for _ in 0..parts {
                    let mut total_nm = torque_nm;
                    if at_recorded {
                        let middle = (elapsed_s + 0.5 * part_s) / self.period_s;
                        let angle_rad = per_turn * self.recorded_rad(vector, at, middle);
                        total_nm += cogging_nm * (angle_rad + phase_rad).sin();
                    }
                    plant.step(total_nm, part_s).ok()?;
                    elapsed_s += part_s;
                }
            }
        }
        Some(turned_rad)
    }

    /// The motor's angle by its own encoder, this part of a period after a sample. Cogging by the angle that is
    /// recorded moves the model the right way from far away; by the model's own angle, it holds the model in the
    /// wrong dent.
    fn recorded_rad(&self, vector: &Vector, at: usize, part: f64) -> f64 {
        let counts = &self.smooth_counts;
        let next = counts[(at + 1).min(counts.len() - 1)];
        let shown_counts = self.first_counts[0] + counts[at] + part * (next - counts[at]);
        let shown_rad = shown_counts / self.counts_per_rad[0];
        shown_rad - error_rad(vector, 0, shown_rad)
    }

    /// Angle of a shaft at the first sample. An eccentric encoder shows another one.
    fn first_rad(&self, vector: &Vector, own: &OwnParameters, encoder: usize) -> f64 {
        let shown_rad = (self.first_counts[encoder] + own.offsets[encoder]) / self.counts_per_rad[encoder];
        // The error itself is small, so two rounds leave its third power.
        (0..2).fold(shown_rad, |it, _| shown_rad - error_rad(vector, encoder, it))
    }

    fn shown(&self, vector: &Vector, own: &OwnParameters, turned_rad: [Vec<f64>; 2]) -> Prediction {
        let counts = [0, 1].map(|encoder| {
            let first_rad = self.first_rad(vector, own, encoder);
            let first_error_rad = error_rad(vector, encoder, first_rad);
            let shown = |&turned_rad: &f64| {
                let error_rad = error_rad(vector, encoder, first_rad + turned_rad) - first_error_rad;
                (turned_rad + error_rad) * self.counts_per_rad[encoder]
            };
            turned_rad[encoder].iter().map(shown).collect()
        });
        Prediction { turned_rad, counts }
    }
}

/// What an eccentric encoder shows on top of an angle of its shaft.
fn error_rad(vector: &Vector, encoder: usize, angle_rad: f64) -> f64 {
    let [cosine_rad, sine_rad] = Parameter::OF_ENCODERS[encoder].map(|it| vector.get(it));
    let (sine, cosine) = angle_rad.sin_cos();
    cosine_rad * cosine + sine_rad * sine
}

/// Counts by the parabola of least squares through the samples around each.
fn smoothed(counts: &[f64]) -> Vec<f64> {
    /// On either side.
    const AROUND: usize = 2;
    let [number, square] = [2 * AROUND + 1, AROUND * (AROUND + 1)].map(|it| it as f64);
    // Of Savitzky and Golay, for the middle of a window.
    let scale = number * (4.0 * square - 3.0) / 3.0;
    let weight = |place: usize| (3.0 * square - 1.0 - 5.0 * (place as f64 - AROUND as f64).powi(2)) / scale;
    let weights: Vec<f64> = (0..=2 * AROUND).map(weight).collect();
    let mut smooth = counts.to_vec();
    for (at, window) in counts.windows(weights.len()).enumerate() {
        smooth[at + AROUND] = window.iter().zip(&weights).map(|(count, weight)| count * weight).sum();
    }
    smooth
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
    // What holds the drive train has arrived before the first sample.
    let before = if series.held_nm() == 0.0 { 0 } else { delay_us.div_ceil(series.period_us()) };
    (0..before).for_each(|_| delay.step(torque_nm(series.held_nm())).for_each(drop));
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
