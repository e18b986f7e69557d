//! The torques of a measurement, and which steps of it count.
//!
//! A segment is one excitation with one set of phases: windows in which the loop settles, then windows that count. A multisine
//! has all tones in every segment. A stepped sine has a segment for each tone, with a window of whole cycles of its own.

use lashloop_plant::reference::Tones;

/// How the loop is excited.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Excitation {
    /// All tones at once, at odd multiples of 1 / period.
    Multisine,
    /// One tone after the other.
    Sine,
}

/// What is excited, and how long.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plan {
    /// Control period in us.
    pub control_period_us: u32,
    /// Tones at once, or one after the other.
    pub excitation: Excitation,
    /// Largest excitation, in N m for a torque and in rad for a reference.
    pub amplitude: f64,
    /// Frequency of the lowest tone in Hz. A window of the multisine is its period.
    pub lowest_hz: f64,
    /// Frequency in Hz that no tone exceeds.
    pub highest_hz: f64,
    /// Tones at most, at about equal ratios.
    pub lines: u32,
    /// Sets of phases.
    pub realisations: u32,
    /// Windows per segment that count.
    pub windows: u32,
    /// Time in s for which a segment settles at least, in whole windows; the first one settles for twice as long.
    pub settles_s: f64,
    /// Seed of all phases.
    pub seed: u64,
}

/// Shortest window of a stepped sine, in s and in cycles.
const SINE_WINDOW_S: f64 = 0.5;
const SINE_CYCLES: f64 = 3.0;
/// Fewest realisations: with two the scatter is known to a factor of ten only.
const LEAST_REALISATIONS: u32 = 3;
/// Most steps of a measurement, which are held in memory.
const MOST_STEPS: f64 = 2e7;

/// Why a plan can't be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PlanError {
    /// A tone above half of the sampling frequency shows as another one.
    #[error(
        "the highest frequency, {highest_hz} Hz, is above half of the sampling frequency of the loop; at a period of \
         {control_period_us} us take at most {nyquist_hz} Hz"
    )]
    BeyondNyquist {
        /// The frequency asked for.
        highest_hz: f64,
        /// Control period.
        control_period_us: u32,
        /// Half of the sampling frequency.
        nyquist_hz: f64,
    },
    /// The range is empty or not positive.
    #[error(
        "the frequencies from {lowest_hz} Hz to {highest_hz} Hz are not a range; the lowest must be above 0 and below the highest"
    )]
    EmptyRange {
        /// Lower end.
        lowest_hz: f64,
        /// Upper end.
        highest_hz: f64,
    },
    /// The amplitude isn't a positive number.
    #[error("an amplitude of {amplitude} excites nothing; it must be above 0")]
    Amplitude {
        /// What was asked for.
        amplitude: f64,
    },
    /// Too few sets of phases for a scatter.
    #[error("{realisations} realisations show no scatter; take at least {LEAST_REALISATIONS}")]
    Realisations {
        /// What was asked for.
        realisations: u32,
    },
    /// The measurement has no line, or no window.
    #[error("a measurement needs at least one line, one window and a time to settle that is not negative")]
    Nothing,
    /// The measurement would not end.
    #[error(
        "the measurement would take {seconds:.0} s of the loop; take fewer lines, windows or realisations, or a higher lowest frequency"
    )]
    TooLong {
        /// Its time.
        seconds: f64,
    },
}

/// A part of a measurement with one set of phases.
#[derive(Debug, Clone, PartialEq)]
pub struct Segment {
    /// Its realisation, from 0.
    pub realisation: usize,
    /// First step that counts.
    pub first: usize,
    /// Steps of a window.
    pub window: usize,
    /// Windows that count.
    pub windows: usize,
    /// Its tones: index of the line, and cycles per window.
    pub tones: Vec<(usize, usize)>,
}

impl Segment {
    /// Samples of a window that lie at different places of the cycle of a tone.
    #[must_use]
    pub fn places(&self, cycles: usize) -> usize {
        let (mut of, mut rest) = (self.window, cycles);
        while rest > 0 {
            (of, rest) = (rest, of % rest);
        }
        self.window / of.max(1)
    }
}

/// The excitation of a measurement.
#[derive(Debug, Clone, PartialEq)]
pub struct Planned {
    /// Tones at once, or one after the other.
    pub excitation: Excitation,
    /// The excitation in each step, in the unit of the amplitude. It is the `f32` that acts.
    pub values: Vec<f32>,
    /// Frequencies of the lines in Hz, from low to high.
    pub frequencies_hz: Vec<f64>,
    /// Its parts in order.
    pub segments: Vec<Segment>,
}

impl Plan {
    /// Control period in s.
    #[must_use]
    pub fn period_s(&self) -> f64 {
        f64::from(self.control_period_us) / 1e6
    }

    /// The excitation, step by step.
    ///
    /// # Errors
    /// The plan has no tones, excites nothing, or takes too long.
    pub fn make(&self) -> Result<Planned, PlanError> {
        let Self { lowest_hz, highest_hz, amplitude, realisations, control_period_us, .. } = *self;
        let nyquist_hz = 0.5 / self.period_s();
        if !(lowest_hz > 0.0 && lowest_hz < highest_hz && highest_hz.is_finite()) {
            return Err(PlanError::EmptyRange { lowest_hz, highest_hz });
        }
        if highest_hz > nyquist_hz {
            return Err(PlanError::BeyondNyquist { highest_hz, control_period_us, nyquist_hz });
        }
        if !(amplitude > 0.0 && amplitude.is_finite()) {
            return Err(PlanError::Amplitude { amplitude });
        }
        if realisations < LEAST_REALISATIONS {
            return Err(PlanError::Realisations { realisations });
        }
        if self.lines == 0 || self.windows == 0 || self.settles_s.is_nan() || self.settles_s < 0.0 {
            return Err(PlanError::Nothing);
        }
        let parts = self.parts();
        let steps = parts.iter().map(|part| part.steps(self.windows) as f64).sum::<f64>();
        let seconds = steps * f64::from(realisations) * self.period_s();
        if seconds / self.period_s() > MOST_STEPS {
            return Err(PlanError::TooLong { seconds });
        }
        Ok(self.excite(&parts))
    }

    /// The parts of a realisation.
    fn parts(&self) -> Vec<Part> {
        let at_hz = 1.0 / self.period_s();
        match self.excitation {
            Excitation::Multisine => {
                let window = (at_hz / self.lowest_hz).round().max(2.0);
                let highest = (self.highest_hz * window / at_hz).min(window / 2.0 - 1.0);
                let harmonics = Tones::odd_harmonics(1.0, highest, self.lines);
                vec![self.part(window as usize, harmonics)]
            }
            Excitation::Sine => {
                let growth = (self.highest_hz / self.lowest_hz).ln() / f64::from(self.lines.max(2) - 1);
                let part = |line: u32| {
                    let wanted_hz = self.lowest_hz * (growth * f64::from(line)).exp();
                    let cycles = (SINE_WINDOW_S * wanted_hz).ceil().max(SINE_CYCLES);
                    // At least two steps per cycle, whatever rounding does.
                    let window = (cycles * at_hz / wanted_hz).round().max(2.0 * cycles + 1.0) as usize;
                    self.part(window, vec![cycles as u32])
                };
                (0..self.lines).map(part).collect()
            }
        }
    }

    fn part(&self, window: usize, harmonics: Vec<u32>) -> Part {
        let windows = (self.settles_s / self.period_s() / window as f64).ceil().max(1.0);
        Part { window, settles: windows as usize * window, harmonics }
    }

    fn excite(&self, parts: &[Part]) -> Planned {
        let mut planned = Planned {
            excitation: self.excitation,
            values: Vec::new(),
            frequencies_hz: Vec::new(),
            segments: Vec::new(),
        };
        for part in parts {
            let of = |it: &u32| f64::from(*it) / (part.window as f64 * self.period_s());
            planned.frequencies_hz.extend(part.harmonics.iter().map(of));
        }
        for realisation in 0..self.realisations as usize {
            let mut line = 0;
            for (number, part) in parts.iter().enumerate() {
                // Phases of a segment depend on neither the other segments nor their number.
                let seed = self.seed ^ ((realisation as u64) << 40) ^ ((number as u64) << 20);
                let tones = Tones::new(part.window as f64, &part.harmonics, seed);
                // A stepped sine begins at zero always. Its realisations differ by where in its cycle the samples lie.
                let shift = match self.excitation {
                    Excitation::Multisine => 0.0,
                    Excitation::Sine => realisation as f64 / f64::from(self.realisations),
                };
                let begin = planned.values.len();
                let more = if begin == 0 { part.settles } else { 0 };
                let value = |step: usize| (self.amplitude * tones.at(step as f64 + shift)) as f32;
                planned.values.extend((0..more + part.steps(self.windows)).map(value));
                planned.segments.push(Segment {
                    realisation,
                    first: begin + more + part.settles,
                    window: part.window,
                    windows: self.windows as usize,
                    tones: part
                        .harmonics
                        .iter()
                        .enumerate()
                        .map(|(at, it)| (line + at, *it as usize))
                        .collect(),
                });
                line += part.harmonics.len();
            }
        }
        planned
    }
}

/// A segment before it has phases.
struct Part {
    /// Steps of a window.
    window: usize,
    /// Steps before the first window that counts.
    settles: usize,
    /// Cycles per window.
    harmonics: Vec<u32>,
}

impl Part {
    fn steps(&self, windows: u32) -> usize {
        self.settles + self.window * windows as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLAN: Plan = Plan {
        control_period_us: 1000,
        excitation: Excitation::Multisine,
        amplitude: 0.5,
        lowest_hz: 0.5,
        highest_hz: 200.0,
        lines: 30,
        realisations: 3,
        windows: 2,
        settles_s: 3.0,
        seed: 1,
    };

    #[test]
    fn every_tone_fits_a_whole_number_of_times_into_its_window_and_repeats_in_the_next() {
        for excitation in [Excitation::Multisine, Excitation::Sine] {
            let planned = Plan { excitation, ..PLAN }.make().expect("a plan");
            for segment in &planned.segments {
                let Segment { first, window, windows, tones, .. } = segment;
                for &(line, cycles) in tones {
                    let frequency_hz = cycles as f64 / (*window as f64 * 1e-3);
                    assert!((planned.frequencies_hz[line] - frequency_hz).abs() < 1e-9);
                }
                assert!(*first >= 3000 && first + window * windows <= planned.values.len());
                // From the window before on, since the drift is measured against it.
                for step in first - window..first + window * (windows - 1) {
                    let [now, next] = [step, step + window].map(|at| planned.values[at]);
                    assert!((now - next).abs() < 1e-5, "{excitation:?} at step {step}: {now}, {next}");
                }
            }
        }
    }

    #[test]
    fn realisations_differ_in_their_phases() {
        let planned = PLAN.make().expect("a plan");
        let of = |at: usize| &planned.values[planned.segments[at].first..][..planned.segments[at].window];
        assert!(of(0) != of(1) && of(1) != of(2));
    }

    #[test]
    fn amplitude_is_the_largest_value() {
        for excitation in [Excitation::Multisine, Excitation::Sine] {
            let planned = Plan { excitation, ..PLAN }.make().expect("a plan");
            let largest = planned.values.iter().fold(0.0_f32, |largest, it| largest.max(it.abs()));
            assert!((0.48..=0.507).contains(&largest), "{excitation:?}: {largest}");
        }
    }

    #[test]
    fn what_is_wrong_with_a_plan_is_named() {
        let message = |plan: Plan| plan.make().expect_err("a wrong plan").to_string();
        assert!(message(Plan { highest_hz: 501.0, ..PLAN }).contains("take at most 500 Hz"));
        assert!(message(Plan { lowest_hz: 300.0, ..PLAN }).contains("from 300 Hz to 200 Hz are not a range"));
        assert!(message(Plan { amplitude: 0.0, ..PLAN }).contains("excites nothing"));
        assert!(message(Plan { realisations: 2, ..PLAN }).contains("take at least 3"));
        assert!(message(Plan { lowest_hz: 1e-6, ..PLAN }).contains("would take"));
    }
}
