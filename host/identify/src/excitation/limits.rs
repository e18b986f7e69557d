//! The limits that a user confirms before anything moves, and the guard that holds every sample against them.

use std::collections::VecDeque;
use std::fmt;

use crate::series::Instruments;

/// Largest torque, speeds and travel of a commissioning.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Limits {
    /// Largest torque, in either direction.
    pub torque_nm: f64,
    /// Largest speed of the motor.
    pub motor_speed_rad_s: f64,
    /// Largest speed of the load.
    pub load_speed_rad_s: f64,
    /// Largest distance of the load from where it stood at the start.
    pub load_travel_rad: f64,
}

/// A limit that a motion exceeded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Exceeded {
    /// What exceeded it.
    pub quantity: &'static str,
    /// Value at that sample.
    pub value: f64,
    /// The limit.
    pub limit: f64,
    /// Unit of both.
    pub unit: &'static str,
}

impl fmt::Display for Exceeded {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { quantity, value, limit, unit } = self;
        write!(out, "the {quantity} reached {value:.3} {unit}; the limit is {limit} {unit}")
    }
}

/// Why a motion ends before its last torque.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Halt {
    /// The load has moved as far as the motion was to move it.
    Moved,
    /// A limit is exceeded.
    Exceeded(Exceeded),
    /// The drive train still moves from the motion before.
    NotAtRest,
    /// An encoder jitters at rest by more than was stated.
    Noisy(Noisy),
}

/// Jitter of an encoder at rest beyond the noise that was stated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noisy {
    /// `motor` or `load`.
    pub encoder: &'static str,
    /// Amplitude of a uniform noise that jitters as much, in counts.
    pub shown_counts: f64,
    /// The amplitude that was stated.
    pub stated_counts: f64,
}

impl fmt::Display for Noisy {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { encoder, shown_counts, stated_counts } = self;
        write!(
            out,
            "the {encoder} encoder jitters by {shown_counts:.1} counts in either direction at rest, and a noise of \
             {stated_counts} counts is stated"
        )
    }
}

/// Time without torque at the start of a motion, in which the drive train has to be at rest, in s.
pub(crate) const REST_S: f64 = 0.05;
/// The same where there is time to wait, and under a torque that holds the drive train, in s: long enough for a load that creeps to show
/// it.
pub(crate) const LONG_REST_S: f64 = 0.3;
/// Time before that in which the torque arrives and the drive train comes to rest under it, in s: without the torque an offset has
/// moved it.
pub(crate) const LEAD_IN_S: f64 = 0.3;
/// Largest standard deviation of the counts of an encoder at rest: less than a count that comes once. On top, in terms of
/// the noise from sample to sample, which a motion does not raise.
const REST_COUNTS: f64 = 0.3;
const REST_NOISE: f64 = 1.5;
/// The same where noise is stated, for a slow motion hides in it.
const REST_STATED_NOISE: f64 = 0.9;
/// Largest change from the first half of the time to the second, in standard deviations of what the stated noise makes of it.
/// An encoder at rest exceeds it now and then, and the motion is repeated.
const REST_CHANGE: f64 = 0.5;

/// Largest jitter from sample to sample, in counts, of an encoder with less than a count of noise: at an edge it jumps by a
/// count, a standard deviation of 0.5, and 50 samples show that within a third.
const EDGE_COUNTS: f64 = 0.75;
/// Jitter over that of the stated noise from which the noise counts as unstated.
const UNSTATED: f64 = 1.5;

/// Time over which a speed is formed, in s: long against a count, short against an impact.
const SPEED_WINDOW_S: f64 = 0.01;

/// Holds every sample of a motion against the limits.
#[derive(Debug, Clone)]
pub struct Guard {
    limits: Limits,
    counts_per_rad: [f64; 2],
    period_s: f64,
    /// Load counts of motion that end it; `None` for a motion that is made to its end.
    load_counts: Option<i64>,
    /// Load counts at the start of the commissioning.
    origin: Option<i64>,
    recent: VecDeque<[i64; 2]>,
    first_load: Option<i64>,
    rest: Option<Rest>,
    peaks: Peaks,
}

/// The counts of the time at rest. An encoder may be noisy.
#[derive(Debug, Clone)]
struct Rest {
    samples: usize,
    /// First samples that don't count.
    lead_in: usize,
    noise_counts: f64,
    counts: [Vec<f64>; 2],
}

impl Rest {
    fn new(lead_in_s: f64, rest_s: f64, period_s: f64, noise_counts: f64) -> Self {
        let lead_in = (lead_in_s / period_s).round() as usize;
        let samples = lead_in + ((rest_s / period_s).floor() as usize).max(3);
        Self { samples, lead_in, noise_counts, counts: Default::default() }
    }

    fn lasts(&self) -> bool {
        self.counts[0].len() < self.samples
    }

    /// Takes the counts of a sample. Why the motion can't begin; `Some(None)` at rest, `None` as long as the time lasts.
    fn check(&mut self, counts: [i64; 2]) -> Option<Option<Halt>> {
        for (all, now) in self.counts.iter_mut().zip(counts) {
            all.push(now as f64);
        }
        (self.counts[0].len() == self.samples).then(|| self.judge())
    }

    fn judge(&self) -> Option<Halt> {
        let is_noisy = self.noise_counts > 0.0;
        let counts = self.counts.each_ref().map(|counts| &counts[self.lead_in..]);
        if !counts.iter().all(|counts| is_still(counts, is_noisy)) {
            return Some(Halt::NotAtRest);
        }
        let explained = EDGE_COUNTS.hypot(UNSTATED * self.noise_counts / 3.0_f64.sqrt());
        ["motor", "load"].into_iter().zip(counts).find_map(|(encoder, counts)| {
            let jitter = jitter_of_edges(counts);
            let (shown_counts, stated_counts) = (jitter * 3.0_f64.sqrt(), self.noise_counts);
            (jitter > explained).then_some(Halt::Noisy(Noisy { encoder, shown_counts, stated_counts }))
        })
    }
}

/// Standard deviation of the noise of the counts, from sample to sample.
fn jitter(counts: &[f64]) -> f64 {
    let squares = counts.windows(2).map(|pair| (pair[1] - pair[0]).powi(2)).sum::<f64>();
    (squares / (2.0 * (counts.len() as f64 - 1.0))).sqrt()
}

/// The same from second differences, to which a motion adds next to nothing.
fn jitter_of_edges(counts: &[f64]) -> f64 {
    let squares = counts.windows(3).map(|it| (it[2] - 2.0 * it[1] + it[0]).powi(2)).sum::<f64>();
    (squares / (6.0 * (counts.len() as f64 - 2.0))).sqrt()
}

/// Compares the scatter of all samples with that from one sample to the next, as von Neumann's ratio does.
fn is_still(counts: &[f64], is_noisy: bool) -> bool {
    let average = |counts: &[f64]| counts.iter().sum::<f64>() / counts.len() as f64;
    let (number, mean) = (counts.len() as f64, average(counts));
    let variance = counts.iter().map(|it| (it - mean).powi(2)).sum::<f64>() / number;
    let noise = jitter(counts);
    if !is_noisy {
        return variance.sqrt() <= REST_COUNTS + REST_NOISE * noise;
    }
    let (first, second) = counts.split_at(counts.len() / 2);
    let change = (average(second) - average(first)).abs();
    // The difference of two halves has 4 / n of the variance.
    variance.sqrt() <= REST_COUNTS + REST_STATED_NOISE * noise
        && change <= REST_COUNTS.max(REST_CHANGE * 2.0 * noise / number.sqrt())
}

/// Largest values of a motion so far.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Peaks {
    /// Speed of the motor in rad/s.
    pub motor_speed_rad_s: f64,
    /// Speed of the load in rad/s.
    pub load_speed_rad_s: f64,
    /// Distance of the load from the origin in rad.
    pub load_travel_rad: f64,
}

impl Guard {
    /// A guard for one motion. `origin` is the load's count at the start of the commissioning; `None` takes that of the
    /// first sample.
    pub(crate) fn new(
        limits: Limits,
        instruments: &Instruments,
        period_s: f64,
        origin: Option<i64>,
        load_counts: Option<i64>,
    ) -> Self {
        let counts_per_rad = [instruments.motor_counts_per_rad(), instruments.load_counts_per_rad()];
        let (recent, first_load) = (VecDeque::new(), None);
        let rest = Some(Rest::new(0.0, REST_S, period_s, instruments.noise_counts));
        let peaks = Peaks::default();
        Self { limits, counts_per_rad, period_s, load_counts, origin, recent, first_load, rest, peaks }
    }

    /// The same guard of a motion that begins without the time at rest.
    #[must_use]
    pub(crate) fn without_rest(self) -> Self {
        Self { rest: None, ..self }
    }

    /// The same guard of a motion that begins under a torque that holds the drive train.
    #[must_use]
    pub(crate) fn held(self) -> Self {
        let rest = self.rest.map(|it| Rest::new(LEAD_IN_S, LONG_REST_S, self.period_s, it.noise_counts));
        Self { rest, ..self }
    }

    /// The same guard of a motion that begins with the longer time at rest.
    #[must_use]
    pub(crate) fn patient(self) -> Self {
        let rest = self.rest.map(|it| Rest::new(0.0, LONG_REST_S, self.period_s, it.noise_counts));
        Self { rest, ..self }
    }

    /// A guard that never halts, for records and models.
    #[must_use]
    pub fn unlimited(instruments: &Instruments, period_s: f64) -> Self {
        let none = f64::INFINITY;
        let limits = Limits {
            torque_nm: none,
            motor_speed_rad_s: none,
            load_speed_rad_s: none,
            load_travel_rad: none,
        };
        Self { rest: None, ..Self::new(limits, instruments, period_s, None, None) }
    }

    /// Takes the counts of a sample. After a halt no torque may be commanded any more.
    pub fn check(&mut self, motor_counts: i64, load_counts: i64) -> Option<Halt> {
        let window = ((SPEED_WINDOW_S / self.period_s).round() as usize).max(1);
        let first = *self.first_load.get_or_insert(load_counts);
        let origin = *self.origin.get_or_insert(load_counts);
        self.recent.push_back([motor_counts, load_counts]);
        if self.recent.len() > window + 1 {
            self.recent.pop_front();
        }
        let oldest = self.recent[0];
        let elapsed_s = (self.recent.len() - 1).max(1) as f64 * self.period_s;
        let speed = |encoder: usize, now: i64| {
            (now - oldest[encoder]).abs() as f64 / self.counts_per_rad[encoder] / elapsed_s
        };
        // Until the window is full, one count of quantisation would be a large speed.
        let is_full = self.recent.len() > window;
        let [motor_rad_s, load_rad_s] =
            if is_full { [speed(0, motor_counts), speed(1, load_counts)] } else { [0.0; 2] };
        let travel_rad = (load_counts - origin).abs() as f64 / self.counts_per_rad[1];
        let peaks = &mut self.peaks;
        peaks.motor_speed_rad_s = peaks.motor_speed_rad_s.max(motor_rad_s);
        peaks.load_speed_rad_s = peaks.load_speed_rad_s.max(load_rad_s);
        peaks.load_travel_rad = peaks.load_travel_rad.max(travel_rad);
        let checks = [
            ("motor speed", motor_rad_s, self.limits.motor_speed_rad_s, "rad/s"),
            ("load speed", load_rad_s, self.limits.load_speed_rad_s, "rad/s"),
            ("load travel", travel_rad, self.limits.load_travel_rad, "rad"),
        ];
        let exceeded = checks.into_iter().find(|(_, value, limit, _)| value > limit);
        if let Some((quantity, value, limit, unit)) = exceeded {
            return Some(Halt::Exceeded(Exceeded { quantity, value, limit, unit }));
        }
        if let Some(rest) = self.rest.as_mut().filter(|it| it.lasts()) {
            match rest.check([motor_counts, load_counts]) {
                None => return None,
                Some(halt @ Some(_)) => return halt,
                // A lead-in may move the load.
                Some(None) => self.first_load = Some(if rest.lead_in > 0 { load_counts } else { first }),
            }
        }
        let first = self.first_load.unwrap_or(first);
        let moved = (load_counts - first).abs();
        self.load_counts.is_some_and(|most| moved >= most).then_some(Halt::Moved)
    }

    /// Whether the time at rest lasts, before the first torque.
    #[must_use]
    pub fn awaits_torque(&self) -> bool {
        self.rest.as_ref().is_some_and(Rest::lasts)
    }

    /// Largest values so far.
    #[must_use]
    pub fn peaks(&self) -> Peaks {
        self.peaks
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The halt of an encoder at rest whose counts jump by these, one after the other.
    fn halt(jumps: [i64; 5], stated_counts: f64) -> Option<Halt> {
        let mut instruments = Instruments::exact(4000, 4000, 0);
        instruments.noise_counts = stated_counts;
        let limits = Limits {
            torque_nm: 1.0,
            motor_speed_rad_s: 100.0,
            load_speed_rad_s: 100.0,
            load_travel_rad: 1.0,
        };
        let mut guard = Guard::new(limits, &instruments, 1e-3, None, None);
        let samples = (REST_S * 1e3) as usize;
        (0..samples).find_map(|at| guard.check(7, 100 + jumps[at % jumps.len()]))
    }

    #[test]
    fn unstated_noise_is_named_with_its_size_and_stated_noise_is_not() {
        let Some(Halt::Noisy(noisy)) = halt([2, -1, 1, -2, 0], 0.0) else { panic!("noise of 2 counts") };
        assert_eq!((noisy.encoder, noisy.stated_counts), ("load", 0.0));
        assert!((1.5..4.0).contains(&noisy.shown_counts), "{noisy}");
        assert_eq!(halt([2, -1, 1, -2, 0], 2.0), None);
    }

    /// A load that moves by a count each period up to this time, under a torque that holds it.
    fn halt_of_held(moves_s: f64) -> Option<Halt> {
        let limits = Limits {
            torque_nm: 1.0,
            motor_speed_rad_s: 100.0,
            load_speed_rad_s: 100.0,
            load_travel_rad: 1.0,
        };
        let mut guard = Guard::new(limits, &Instruments::exact(4000, 4000, 0), 1e-3, None, Some(4)).held();
        let (moves, samples) = ((moves_s * 1e3) as i64, ((LEAD_IN_S + LONG_REST_S) * 1e3) as i64);
        (0..samples).find_map(|at| guard.check(7, at.min(moves)))
    }

    #[test]
    fn a_held_load_may_move_in_the_lead_in_and_not_after_it() {
        assert_eq!(halt_of_held(LEAD_IN_S - 0.01), None);
        assert_eq!(halt_of_held(LEAD_IN_S + 0.05), Some(Halt::NotAtRest));
    }

    #[test]
    fn an_encoder_at_an_edge_is_not_noisy() {
        assert_eq!(halt([0, 1, 1, 0, 0], 0.0), None);
        assert_eq!(halt([0; 5], 0.0), None);
    }
}
