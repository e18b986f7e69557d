//! Responses with coherence and deviation, from the realisations of a measurement.
//!
//! Every signal is taken relative to the excitation, which is known exactly, and a response is a ratio of two means: noise at
//! the encoders goes around the loop, so a ratio of spectra of one realisation would be biased, and a ratio of means isn't.

use rustfft::num_complex::Complex;

use crate::plan::{Excitation, Planned, Segment};
use crate::spectrum::Spectrum;
use crate::student;

/// A response at one frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// Frequency.
    pub frequency_hz: f64,
    /// The response.
    pub value: Complex<f64>,
    /// Standard deviation of real and of imaginary part, each, from the scatter of the realisations.
    pub deviation: f64,
    /// Share of the power of a realisation that the response explains, 0 to 1.
    pub coherence: f64,
    /// Realisations that it is a mean of.
    pub realisations: u32,
}

impl Line {
    /// Magnitude in dB.
    #[must_use]
    pub fn decibels(&self) -> f64 {
        decibels(self.value.norm())
    }

    /// Phase in degrees, above -180 and up to 180.
    #[must_use]
    pub fn phase_deg(&self) -> f64 {
        self.value.arg().to_degrees()
    }

    /// The open loop of a line of the sensitivity: L = 1 / S - 1.
    fn loop_of_sensitivity(&self) -> Self {
        let value = 1.0 / self.value - 1.0;
        let deviation = self.deviation / self.value.norm_sqr();
        // That of a mean of as many realisations as the sensitivity is a mean of.
        let of_one = 2.0 * f64::from(self.realisations) * deviation.powi(2);
        let coherence = value.norm_sqr() / (value.norm_sqr() + of_one);
        Self { value, deviation, coherence, ..*self }
    }

    /// Factor on the deviation for an interval of 95 %.
    #[must_use]
    pub fn t95(&self) -> f64 {
        student::within_95_percent(2.0 * (f64::from(self.realisations) - 1.0))
    }

    /// Adds a deviation that the realisations have in common.
    fn doubt(&mut self, deviation: f64) {
        self.deviation = self.deviation.hypot(deviation);
        let power = self.value.norm_sqr();
        self.coherence = self.coherence.min(power / (power + 2.0 * deviation.powi(2)));
    }

    /// Half of the 95 % interval of the magnitude, in dB.
    #[must_use]
    pub fn within_db(&self) -> f64 {
        decibels(1.0 + self.t95() * self.deviation / self.value.norm())
    }

    /// Half of the 95 % interval of the phase, in degrees; 180 if the response doesn't rise above its scatter.
    #[must_use]
    pub fn within_deg(&self) -> f64 {
        let share = self.t95() * self.deviation / self.value.norm();
        if share < 1.0 { share.asin().to_degrees() } else { 180.0 }
    }
}

/// 20 log10 of a magnitude.
#[must_use]
pub fn decibels(magnitude: f64) -> f64 {
    20.0 * magnitude.log10()
}

/// What was excited.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Excited {
    /// A torque d at the input of the plant, on top of that of the drive.
    Torque,
    /// The reference of the drive.
    Reference,
}

/// The signals of a measurement, one value per step.
#[derive(Debug, Clone, Copy)]
pub struct Signals<'a> {
    /// What excites: the torque d in N m, or the reference in rad.
    pub excitation: &'a [f64],
    /// Torque U of the drive, in N m.
    pub torque_nm: &'a [f64],
    /// Position of the motor, in rad.
    pub motor_rad: &'a [f64],
    /// Position of the load, in rad.
    pub load_rad: &'a [f64],
    /// A count of the encoders of motor and load, in rad.
    pub count_rad: [f64; 2],
}

impl Signals<'_> {
    /// Root mean square of the twist theta_e - N0 theta_s around its mean, in rad, over the windows that count.
    #[must_use]
    pub fn twist_rms_rad(&self, planned: &Planned, reduction_ratio: f64) -> f64 {
        let (mut squares, mut count) = (0.0, 0.0_f64);
        for &Segment { first, window, windows, .. } in &planned.segments {
            let steps = first..first + window * windows;
            let twists: Vec<f64> =
                steps.map(|at| self.motor_rad[at] - reduction_ratio * self.load_rad[at]).collect();
            let mean = twists.iter().sum::<f64>() / twists.len() as f64;
            squares += twists.iter().map(|it| (it - mean).powi(2)).sum::<f64>();
            count += twists.len() as f64;
        }
        (squares / count.max(1.0)).sqrt()
    }
}

/// Why signals show no response.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ResponseError {
    /// The run ended before the measurement.
    #[error("the run has {have} steps, and the measurement needs {want}; the run must not end before")]
    TooShort {
        /// Steps of the run.
        have: usize,
        /// Steps of the measurement.
        want: usize,
    },
    /// Nothing follows the excitation.
    #[error(
        "no line is coherent: the largest coherence of the {whose} response is {largest:.2}, below {least}; raise the amplitude, \
         or lower the highest frequency"
    )]
    NotCoherent {
        /// Whose response.
        whose: &'static str,
        /// Largest coherence.
        largest: f64,
        /// Least coherence that counts.
        least: f64,
    },
}

/// Coherence from which a line counts in margins and fits.
pub const LEAST_COHERENCE: f64 = 0.6;

/// Magnitude of an open loop below which at every line the law answers nothing.
const NO_LOOP: f64 = 1e-6;

/// The responses of a measurement, each at all lines.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// Plant theta_e / u: position of the motor by the torque, in rad/N m.
    pub motor: Vec<Line>,
    /// Plant theta_s / u: position of the load by the torque, in rad/N m.
    pub load: Vec<Line>,
    /// Sensitivity S = u / d; none if the reference was excited, or the law closes no loop.
    pub sensitivity: Vec<Line>,
    /// Open loop L = -U / u, of the loop cut at the plant's input; none as for the sensitivity.
    pub open_loop: Vec<Line>,
    /// Closed loop theta_s / r; none if a torque was excited.
    pub closed_loop: Vec<Line>,
    /// Amplitude of the torque u at each line, in N m: its mean over the realisations.
    pub torque_nm: Vec<f64>,
}

/// The spectra of all realisations at one line, relative to the excitation.
#[derive(Clone, Default)]
struct Spectra {
    excitation: Vec<Complex<f64>>,
    torque: Vec<Complex<f64>>,
    motor: Vec<Complex<f64>>,
    load: Vec<Complex<f64>>,
}

impl Measured {
    /// The responses that the signals show.
    ///
    /// # Errors
    /// The signals are shorter than the measurement, or follow nothing of it.
    pub fn of(planned: &Planned, excited: Excited, signals: Signals<'_>) -> Result<Self, ResponseError> {
        let Signals { excitation, torque_nm, motor_rad, load_rad, .. } = signals;
        let have =
            [excitation, torque_nm, motor_rad, load_rad].map(<[f64]>::len).into_iter().min().unwrap_or(0);
        let want = planned.values.len();
        if have < want {
            return Err(ResponseError::TooShort { have, want });
        }
        let lines = spectra(planned, excited, signals);
        let each = |of: &dyn Fn(&Spectra) -> Ratio| -> Vec<Line> {
            let frequencies = planned.frequencies_hz.iter();
            lines.iter().zip(frequencies).map(|(line, &frequency_hz)| of(line).line(frequency_hz)).collect()
        };
        let is_torque = excited == Excited::Torque;
        let only = |wanted: bool, of: &dyn Fn(&Spectra) -> Ratio| if wanted { each(of) } else { Vec::new() };
        let ones = |line: &Spectra| vec![Complex::new(1.0, 0.0); line.torque.len()];
        let sensitivity = only(is_torque, &|line| Ratio::of(&line.torque, &ones(line)));
        let amplitude = |line: &Spectra| {
            let each = line.torque.iter().zip(&line.excitation).map(|(u, d)| (u * d).norm());
            each.sum::<f64>() / line.torque.len() as f64
        };
        let mut measured = Self {
            motor: each(&|line| Ratio::of(&line.motor, &line.torque)),
            load: each(&|line| Ratio::of(&line.load, &line.torque)),
            open_loop: sensitivity.iter().map(Line::loop_of_sensitivity).collect(),
            sensitivity,
            closed_loop: only(!is_torque, &|line| Ratio::of(&line.load, &ones(line))),
            torque_nm: lines.iter().map(amplitude).collect(),
        };
        if measured.open_loop.iter().all(|it| it.value.norm() < NO_LOOP) {
            (measured.open_loop, measured.sensitivity) = Default::default();
        }
        if planned.excitation == Excitation::Sine {
            measured.count_quantisation(planned, signals.count_rad);
        }
        // A law that hunts moves the plant too, and the plant answers coherently; the loop then doesn't answer the excitation.
        let checked = [("plant's", &measured.motor), ("loop's", &measured.sensitivity)];
        for (whose, lines) in checked.into_iter().filter(|(_, lines)| !lines.is_empty()) {
            let largest = lines.iter().map(|it| it.coherence).fold(0.0, f64::max);
            if largest < LEAST_COHERENCE {
                return Err(ResponseError::NotCoherent { whose, largest, least: LEAST_COHERENCE });
            }
        }
        Ok(measured)
    }

    /// Adds what the counting of a sine leaves, which is alike in all realisations, so that none of them shows it. Other tones at
    /// the same time, as in a multisine, make noise of it.
    fn count_quantisation(&mut self, planned: &Planned, count_rad: [f64; 2]) {
        let mut places = vec![1.0; self.torque_nm.len()];
        for segment in &planned.segments {
            for &(line, cycles) in &segment.tones {
                places[line] = segment.places(cycles) as f64;
            }
        }
        let Self { motor, load, open_loop, torque_nm, .. } = self;
        let error_rad = |line: &Line, at: usize, count_rad: f64| {
            error_of_counting(line.value.norm() * torque_nm[at], count_rad, places[at])
        };
        // The open loop is the law's answer to counts, for the most part to those of the motor.
        for (at, (open, line)) in open_loop.iter_mut().zip(&*motor).enumerate() {
            let share = error_rad(line, at, count_rad[0]) / (line.value.norm() * torque_nm[at]);
            open.doubt(open.value.norm() * share);
        }
        for (lines, count_rad) in [motor, load].into_iter().zip(count_rad) {
            for (at, line) in lines.iter_mut().enumerate() {
                line.doubt(error_rad(line, at, count_rad) / torque_nm[at]);
            }
        }
    }
}

/// Root mean square of the error of the first harmonic of a counted sine, over all its places within a count. With the amplitude A
/// and the count q, the harmonics of the sawtooth of errors add up to q (2 zeta(3) / pi^4 x q / A)^(1/2), and those that the
/// samples fold back are noise of q / 12^(1/2) at the places of the cycle that are sampled. Below a count all of it may be missed.
fn error_of_counting(amplitude_rad: f64, count_rad: f64, places: f64) -> f64 {
    const SAWTOOTH: f64 = 0.157;
    if amplitude_rad < count_rad {
        return count_rad;
    }
    count_rad * (SAWTOOTH * (count_rad / amplitude_rad).sqrt()).hypot((2.0 / 12.0 / places).sqrt())
}

fn spectra(planned: &Planned, excited: Excited, signals: Signals<'_>) -> Vec<Spectra> {
    let excitation = signals.excitation;
    let torque: Vec<f64> = match excited {
        Excited::Torque => {
            signals.torque_nm.iter().zip(excitation).map(|(of_drive, d)| of_drive + d).collect()
        }
        Excited::Reference => signals.torque_nm.to_vec(),
    };
    let mut lines = vec![Spectra::default(); planned.frequencies_hz.len()];
    let mut spectrum: Option<(usize, Spectrum)> = None;
    for segment in by_window(&planned.segments) {
        let window = segment.window;
        let (_, of_window) = match spectrum.take() {
            Some(known) if known.0 == window => spectrum.insert(known),
            _ => spectrum.insert((window, Spectrum::of_windows(window))),
        };
        let tones = |values: &[f64]| of_window.tones(values, segment);
        let [d, u, motor, load] = [excitation, &torque[..], signals.motor_rad, signals.load_rad].map(tones);
        for (at, &(line, _)) in segment.tones.iter().enumerate() {
            let of_line = &mut lines[line];
            of_line.excitation.push(d[at]);
            of_line.torque.push(u[at] / d[at]);
            of_line.motor.push(motor[at] / d[at]);
            of_line.load.push(load[at] / d[at]);
        }
    }
    lines
}

/// The segments in an order in which those of one window follow each other.
fn by_window(segments: &[Segment]) -> Vec<&Segment> {
    let mut sorted: Vec<&Segment> = segments.iter().collect();
    sorted.sort_by_key(|it| (it.window, it.realisation));
    sorted
}

/// A ratio of two means over realisations.
struct Ratio {
    value: Complex<f64>,
    deviation: f64,
    coherence: f64,
    realisations: usize,
}

impl Ratio {
    /// The ratio of the means of `output` and `input`. Its error is that of a realisation, output - ratio x input.
    fn of(output: &[Complex<f64>], input: &[Complex<f64>]) -> Self {
        let count = output.len() as f64;
        let mean = |values: &[Complex<f64>]| values.iter().sum::<Complex<f64>>() / count;
        let mean_input = mean(input);
        let value = mean(output) / mean_input;
        let errors = output.iter().zip(input).map(|(y, u)| (y - value * u).norm_sqr());
        let scatter = errors.sum::<f64>() / (count - 1.0);
        let explained = value.norm_sqr() * input.iter().map(Complex::norm_sqr).sum::<f64>() / count;
        let total = explained + scatter;
        Self {
            value,
            deviation: (scatter / (2.0 * count)).sqrt() / mean_input.norm(),
            coherence: if total > 0.0 { explained / total } else { 0.0 },
            realisations: output.len(),
        }
    }

    fn line(&self, frequency_hz: f64) -> Line {
        let Self { value, deviation, coherence, realisations } = *self;
        Line { frequency_hz, value, deviation, coherence, realisations: realisations as u32 }
    }
}
