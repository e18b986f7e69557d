//! What `lashloop bode` prints: margins, drive train, and the series over the amplitude.

use lashloop::bode::Measurement;
use lashloop_bench::scenario::Scenario;
use lashloop_response::margins::Margin;
use lashloop_response::response::LEAST_COHERENCE;
use lashloop_response::{Estimate, Excitation, Fit, gap};

use super::output::outln;

/// Prints one measurement.
pub(super) fn print(measurement: &Measurement) {
    let Measurement { amplitude, excited, measured, margins, fit, largest_torque_nm, duration_s, .. } =
        measurement;
    let coherent = measured.motor.iter().filter(|it| it.coherence >= LEAST_COHERENCE).count();
    outln!(
        "excitation           {amplitude} {}, {} lines in {duration_s:.0} s of the loop; {coherent} coherent in the plant",
        excited.unit(),
        measured.motor.len()
    );
    outln!("torque of the drive  up to {largest_torque_nm:.3} N m");
    let row = |name: &str, margin: Option<Margin>, unit: &str| {
        if let Some(Margin { frequency_hz, value, within }) = margin {
            outln!("{name:<20} {value:.2}{unit} +-{within:.2}, at {frequency_hz:.3} Hz");
        }
    };
    row("phase margin", margins.phase, " deg");
    if let Some(delay_s) = margins.delay_s() {
        outln!("delay margin         {:.2} ms", 1e3 * delay_s);
    }
    row("gain margin", margins.gain, " dB");
    row("lowest gain", margins.lowest_gain, " dB");
    row("largest sensitivity", margins.sensitivity, "");
    match fit {
        Ok(fit) => print_fit(fit),
        Err(problem) => outln!("drive train          {problem}"),
    }
}

fn print_fit(fit: &Fit) {
    let row = |name: &str, of: Estimate, unit: &str, more: String| {
        let Estimate { value, low, high } = of;
        outln!("{name:<20} {value:.4e}{unit} ({low:.4e} to {high:.4e}){more}");
    };
    let damping = |ratio: f64| format!(", damping {:.1} %", 100.0 * ratio);
    row("antiresonance", fit.antiresonance_hz, " Hz", damping(fit.antiresonance_damping));
    match (fit.resonance_hz, fit.resonance_damping) {
        (Some(resonance), Some(ratio)) => row("resonance", resonance, " Hz", damping(ratio)),
        _ => outln!("resonance            damped away"),
    }
    row("stiffness", fit.stiffness_nm_rad, " N m/rad", String::new());
    row("inertia of motor", fit.motor_inertia_kg_m2, " kg m^2", String::new());
    row("inertia of load", fit.load_inertia_kg_m2, " kg m^2", ", seen from the motor".to_owned());
    row("inertia ratio", fit.inertia_ratio, "", String::new());
    outln!("misfit               {:.1} deviations on {} lines", fit.misfit, fit.lines);
}

/// Prints how the drive train that a response shows depends on the amplitude, next to what the describing function of the gap
/// leaves of the stiffness.
pub(super) fn print_series(scenario: &Scenario, excitation: Excitation, measurements: &[Measurement]) {
    let number = |key: &str| scenario.plant.number(key);
    let gap = number("stiffness_nm_rad").zip(number("dead_zone_rad"));
    let unit = measurements.first().map_or("", |it| it.excited.unit());
    outln!(
        "\n{:>12} {:>14} {:>16} {:>16} {:>20}",
        "amplitude",
        "resonance",
        "stiffness",
        "twist, rms",
        "describing function"
    );
    outln!("{unit:>12} {:>14} {:>16} {:>16} {:>20}", "Hz", "N m/rad", "rad", "N m/rad");
    for Measurement { amplitude, fit, twist_rms_rad, .. } in measurements {
        let text = |value: Option<f64>| value.map_or("-".to_owned(), |it| format!("{it:.4}"));
        let fit = fit.as_ref().ok();
        let predicted = gap.zip(*twist_rms_rad).map(|((stiffness, half_gap), rms)| {
            stiffness
                * match excitation {
                    Excitation::Multisine => gap::share_for_noise(rms / half_gap),
                    Excitation::Sine => gap::share_for_sine(rms * 2.0_f64.sqrt() / half_gap),
                }
        });
        let resonance = text(fit.and_then(|it| it.resonance_hz).map(|it| it.value));
        let stiffness = text(fit.map(|it| it.stiffness_nm_rad.value));
        outln!(
            "{amplitude:>12} {resonance:>14} {stiffness:>16} {:>16} {:>20}",
            text(*twist_rms_rad),
            text(predicted)
        );
    }
}
