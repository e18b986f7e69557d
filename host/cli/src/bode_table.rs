//! What `lashloop bode` prints and shows on its page: margins, drive train, and the series over the amplitude.

use lashloop::bode::Measurement;
use lashloop_bench::number::Shown;
use lashloop_bench::scenario::Scenario;
use lashloop_response::margins::Margin;
use lashloop_response::response::LEAST_COHERENCE;
use lashloop_response::{Estimate, Excitation, Fit, gap};

/// One measurement, as lines.
pub(super) fn of_one(measurement: &Measurement) -> Vec<String> {
    let Measurement {
        amplitude,
        excited,
        measured,
        margins,
        fit,
        largest_torque_nm,
        duration_s,
        is_in_motion,
        ..
    } = measurement;
    let coherent = measured.motor.iter().filter(|it| it.coherence >= LEAST_COHERENCE).count();
    let (unit, lines) = (excited.unit(), measured.motor.len());
    let mut text = vec![
        format!(
            "excitation           {amplitude} {unit} for {duration_s:.0} s, {coherent} of {lines} lines coherent"
        ),
        format!("torque of the drive  up to {largest_torque_nm:.3} N m"),
    ];
    let margin = |name: &str, margin: Option<Margin>, unit: &str| {
        margin.map(|Margin { frequency_hz, value, within }| {
            format!("{name:<20} {value:.2}{unit} +-{within:.2}, at {frequency_hz:.3} Hz")
        })
    };
    text.extend(margin("phase margin", margins.phase, " deg"));
    text.extend(margins.delay_s.map(|delay_s| format!("delay margin         {:.2} ms", 1e3 * delay_s)));
    text.extend(margin("gain margin", margins.gain, " dB"));
    text.extend(margin("lowest gain", margins.lowest_gain, " dB"));
    text.extend(margin("largest sensitivity", margins.sensitivity, ""));
    if let Some(it) = margins.phase.filter(|it| it.within > it.value.abs()) {
        text.push(format!(
            "note                 the phase margin is within {:.2} deg of 0: more realisations show its sign",
            it.within
        ));
    }
    match fit {
        Ok(fit) => text.extend(of_fit(fit)),
        Err(problem) => text.push(format!("drive train          {problem}")),
    }
    if fit.is_ok() && !is_in_motion {
        text.push(
            "note                 the load turned back or stood: if friction held it or the gap opened, the drive train \
             above is that of a held load; measure in motion, see --speed"
                .to_owned(),
        );
    }
    text
}

fn of_fit(fit: &Fit) -> [String; 7] {
    let row = |name: &str, of: Estimate, unit: &str, more: &str| {
        let [value, low, high] = [of.value, of.low, of.high].map(Shown);
        format!("{name:<20} {value}{unit} ({low} to {high}){more}")
    };
    let damping = |ratio: f64| format!(", damping {:.1} %", 100.0 * ratio);
    [
        row("antiresonance", fit.antiresonance_hz, " Hz", &damping(fit.antiresonance_damping)),
        match (fit.resonance_hz, fit.resonance_damping) {
            (Some(resonance), Some(ratio)) => row("resonance", resonance, " Hz", &damping(ratio)),
            _ => "resonance            damped away".to_owned(),
        },
        row("stiffness", fit.stiffness_nm_rad, " N m/rad", ""),
        row("inertia of motor", fit.motor_inertia_kg_m2, " kg m^2", ""),
        row("inertia of load", fit.load_inertia_kg_m2, " kg m^2", ", seen from the motor"),
        row("inertia ratio", fit.inertia_ratio, "", ""),
        format!("misfit               {:.1} deviations on {} lines", fit.misfit, fit.lines),
    ]
}

/// How the drive train that a response shows depends on the amplitude, next to what the describing function of the gap leaves of
/// the stiffness.
pub(super) fn of_series(
    scenario: &Scenario,
    excitation: Excitation,
    measurements: &[Measurement],
) -> Vec<String> {
    let number = |key: &str| scenario.plant.number(key);
    let gap = number("stiffness_nm_rad").zip(number("dead_zone_rad"));
    let unit = measurements.first().map_or("", |it| it.excited.unit());
    let row = |cells: [&str; 5]| {
        let [amplitude, resonance, stiffness, twist, predicted] = cells;
        format!("{amplitude:>10} {resonance:>12} {stiffness:>12} {twist:>12} {predicted:>20}")
    };
    let mut text = vec![
        String::new(),
        row(["amplitude", "resonance", "stiffness", "twist, rms", "describing function"]),
        row([unit, "Hz", "N m/rad", "rad", "N m/rad"]),
    ];
    for Measurement { amplitude, fit, twist_rms_rad, .. } in measurements {
        let cell = |value: Option<f64>| value.map_or("-".to_owned(), |it| format!("{it:.4}"));
        let fit = fit.as_ref().ok();
        let predicted = gap.zip(*twist_rms_rad).map(|((stiffness, half_gap), rms)| {
            let share = match excitation {
                Excitation::Multisine => gap::share_for_noise(rms / half_gap),
                Excitation::Sine => gap::share_for_sine(rms * 2.0_f64.sqrt() / half_gap),
            };
            stiffness * share
        });
        text.push(row([
            &amplitude.to_string(),
            &cell(fit.and_then(|it| it.resonance_hz).map(|it| it.value)),
            &cell(fit.map(|it| it.stiffness_nm_rad.value)),
            &cell(*twist_rms_rad),
            &cell(predicted),
        ]));
    }
    text
}
