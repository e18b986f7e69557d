//! What torque and encoders are off by, as quantities.

use serde::Serialize;

use crate::fit::Fit;
use crate::parameters::Parameter;
use crate::prior::Prior;
use crate::quantity::{DEVIATIONS, Estimate, Quantity};
use crate::series::Instruments;

/// Standard deviations of half an interval of 95 % of a normal error.
const NORMAL_DEVIATIONS: f64 = 1.96;
/// Widest interval of a phase that is reported, as half of it in rad.
const WIDEST_PHASE_RAD: f64 = 1.0;
/// Standard deviation of what the motions show, as a fraction of the one before, from which they don't show it.
const SHOWN: f64 = 0.5;

/// Where the error of an encoder within its turn is from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Source {
    /// The motions are long enough to show it.
    Fitted,
    /// It is stated: the intervals have it as a floor.
    Given,
}

/// What is known of an encoder's error within a turn.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct EncoderError {
    /// Largest error that was stated, or that of an encoder of which nothing is stated, in rad of its shaft.
    pub stated_rad: f64,
    /// Whether the motions show the eccentricity.
    pub source: Source,
}

/// The errors of motor and load encoder.
pub(crate) fn encoder_errors(fit: &Fit, prior: &Prior, stated_rad: [f64; 2]) -> [EncoderError; 2] {
    [0, 1].map(|encoder| {
        let of = Parameter::OF_ENCODERS[encoder];
        let is_fitted = of.iter().all(|it| is_shown(fit, prior, *it));
        let source = if is_fitted { Source::Fitted } else { Source::Given };
        EncoderError { stated_rad: stated_rad[encoder], source }
    })
}

fn is_shown(fit: &Fit, prior: &Prior, parameter: Parameter) -> bool {
    deviation(fit, parameter) < SHOWN * prior.deviation(parameter)
}

fn deviation(fit: &Fit, parameter: Parameter) -> f64 {
    let at = parameter as usize;
    fit.covariance[(at, at)].max(0.0).sqrt()
}

/// Standard deviations in N m of what is unknown of the torque; `None` where the motions show too little of it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TorqueDoubt {
    /// Of the offset, once the estimate of it is taken away.
    pub offset_nm: Option<f64>,
    /// Of the torque that repeats in every turn, with the cogging left as it is.
    pub ripple_nm: Option<f64>,
    /// The same with the cogging taken away; `None` too if its phase isn't known.
    pub compensated_ripple_nm: Option<f64>,
}

impl TorqueDoubt {
    pub(crate) fn new(fit: &Fit, prior: &Prior, phase: Option<Estimate>) -> Self {
        // Quantisation isn't normally distributed, so the deviations of the fit are too small, as half an interval is too narrow.
        const WIDER: f64 = DEVIATIONS / NORMAL_DEVIATIONS;
        let cogging = Wave::of(fit, Parameter::COGGING);
        let is_cogging_shown = Parameter::COGGING.iter().all(|it| is_shown(fit, prior, *it));
        let variance = WIDER * WIDER * cogging.variance;
        let ripple = |amplitude_nm: f64| (0.5 * (amplitude_nm.powi(2) + variance)).sqrt();
        Self {
            offset_nm: is_shown(fit, prior, Parameter::TorqueOffset)
                .then(|| WIDER * deviation(fit, Parameter::TorqueOffset)),
            ripple_nm: is_cogging_shown.then(|| ripple(cogging.amplitude)),
            compensated_ripple_nm: phase.filter(|_| is_cogging_shown).map(|_| ripple(0.0)),
        }
    }
}

/// Amplitude A and phase p of A sin(angle + p) from its parts of cosine and sine.
struct Wave {
    amplitude: f64,
    /// Standard deviation of the amplitude.
    deviation: f64,
    phase_rad: f64,
    phase_deviation_rad: f64,
    /// Sum of the variances of both parts.
    variance: f64,
}

impl Wave {
    fn of(fit: &Fit, parts: [Parameter; 2]) -> Self {
        let [cosine, sine] = parts.map(|it| fit.point.vector.get(it));
        let at = |i: usize, j: usize| fit.covariance[(parts[i] as usize, parts[j] as usize)];
        let amplitude = cosine.hypot(sine);
        let variance = (at(0, 0) + at(1, 1)).max(0.0);
        let along = |i: f64, j: f64| {
            let variance = i * i * at(0, 0) + 2.0 * i * j * at(0, 1) + j * j * at(1, 1);
            variance.max(0.0).sqrt() / amplitude
        };
        let is_clear = amplitude > DEVIATIONS * variance.sqrt();
        Self {
            amplitude,
            // A wave that isn't clear has no direction along which its amplitude would vary.
            deviation: if is_clear { along(cosine, sine) } else { variance.sqrt() },
            phase_rad: cosine.atan2(sine),
            phase_deviation_rad: along(-sine, cosine) / amplitude,
            variance,
        }
    }

    fn amplitude(&self) -> Estimate {
        let half = DEVIATIONS * self.deviation;
        let value = self.amplitude;
        Estimate { value, low: (value - half).max(0.0), high: value + half }
    }

    fn is_clear(&self) -> bool {
        self.amplitude().low > 0.0
    }

    /// `edge_rad` is how far the edge of a count may be from where its number says, in the phase.
    fn phase(&self, edge_rad: f64) -> Option<Estimate> {
        let half = (DEVIATIONS * self.phase_deviation_rad).hypot(edge_rad);
        let value = self.phase_rad;
        (self.is_clear() && half < WIDEST_PHASE_RAD).then_some(Estimate {
            value,
            low: value - half,
            high: value + half,
        })
    }
}

/// The quantities of the torque's errors and of both eccentricities.
pub(crate) fn quantities(fit: &Fit, prior: &Prior, instruments: &Instruments) -> Vec<Quantity> {
    let counts_per_rad = [instruments.motor_counts_per_rad(), instruments.load_counts_per_rad()];
    let quantity = |name, unit, meaning, estimate| Quantity {
        name,
        unit,
        meaning,
        estimate,
        plant_key: None,
        drive_parameter: None,
    };
    let key = |of: Quantity| Quantity { plant_key: Some(of.name), ..of };
    let offset_nm = fit.point.vector.get(Parameter::TorqueOffset);
    let offset_deviation_nm = deviation(fit, Parameter::TorqueOffset);
    let half_nm = DEVIATIONS * offset_deviation_nm;
    let is_offset_shown = is_shown(fit, prior, Parameter::TorqueOffset);
    let offset = is_offset_shown.then_some(Estimate {
        value: offset_nm,
        low: offset_nm - half_nm,
        high: offset_nm + half_nm,
    });
    let cogging = Wave::of(fit, Parameter::COGGING);
    let is_cogging_shown = Parameter::COGGING.iter().all(|it| is_shown(fit, prior, *it));
    let shown = |estimate: Option<Estimate>| estimate.filter(|_| is_cogging_shown);
    let per_turn = cogging.is_clear().then(|| per_turn(&fit.per_turn)).flatten();
    let edge_rad = f64::from(fit.point.vector.cogging_per_turn) / counts_per_rad[0];
    let phase = cogging.phase(edge_rad).filter(|_| per_turn.is_some_and(|it| it.low == it.high));
    // A law takes the offset away, and the cogging stays.
    let remains = |amplitude_nm: f64| {
        let ripple = 0.5 * (amplitude_nm.powi(2) + cogging.variance);
        (offset_deviation_nm.powi(2) + ripple).sqrt()
    };
    let mut amplitude = cogging.amplitude();
    if fit.per_turn.is_empty() {
        amplitude.low = 0.0;
    }
    let uncertainty = (is_offset_shown && is_cogging_shown).then(|| Estimate {
        value: remains(amplitude.value),
        low: remains(amplitude.low),
        high: remains(amplitude.high),
    });
    let of_drive = |of: Quantity| Quantity { drive_parameter: Some(of.name), ..of };
    // Without its phase a law can't take the cogging away.
    let of_known_phase = |of: Quantity| if shown(phase).is_some() { of_drive(of) } else { of };
    let mut all = vec![
        of_drive(key(quantity("torque_offset_nm", "N m", "offset of the torque at the motor", offset))),
        of_known_phase(key(quantity(
            "cogging_nm",
            "N m",
            "amplitude of the cogging",
            shown(Some(amplitude)),
        ))),
        of_known_phase(key(quantity(
            "cogging_per_turn",
            "",
            "periods of the cogging per turn of the motor",
            shown(per_turn),
        ))),
        of_known_phase(quantity(
            "cogging_phase_rad",
            "rad",
            "phase of the cogging at the motor encoder's zero",
            shown(phase),
        )),
        quantity(
            "torque_uncertainty_nm",
            "N m",
            "standard deviation of what remains of the torque's errors",
            uncertainty,
        ),
    ];
    let names = [
        ("motor_eccentricity_rad", "motor_eccentricity_phase_rad"),
        ("load_eccentricity_rad", "load_eccentricity_phase_rad"),
    ];
    for ((of, (amplitude, phase)), counts_per_rad) in
        Parameter::OF_ENCODERS.into_iter().zip(names).zip(counts_per_rad)
    {
        let is_shown = of.iter().all(|it| is_shown(fit, prior, *it));
        let wave = is_shown.then(|| Wave::of(fit, of));
        let shown = wave.as_ref().map(Wave::amplitude);
        all.push(quantity(amplitude, "rad", "eccentricity of the encoder", shown));
        all.push(quantity(
            phase,
            "rad",
            "its phase at the encoder's zero",
            wave.and_then(|it| it.phase(1.0 / counts_per_rad)),
        ));
    }
    all
}

fn per_turn(likely: &[u32]) -> Option<Estimate> {
    let [low, high] = [likely.iter().min()?, likely.iter().max()?].map(|it| f64::from(*it));
    Some(Estimate { value: f64::from(*likely.first()?), low, high })
}
