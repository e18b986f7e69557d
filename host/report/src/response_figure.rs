//! Frequency responses as a figure: magnitude and phase of plant and loop, sensitivity, coherence.

use lashloop_plot::{Axis, Figure, Panel, Role, Series};
use lashloop_response::Measured;
use lashloop_response::response::{Excited, LEAST_COHERENCE, Line, decibels};

/// Responses at one amplitude of the excitation.
#[derive(Debug, Clone, Copy)]
pub struct Shown<'a> {
    /// The amplitude, in N m or in rad.
    pub amplitude: f64,
    /// What was excited.
    pub excited: Excited,
    /// The responses.
    pub measured: &'a Measured,
}

/// A curve: its name, its lines, and the number of its colour.
struct Curve<'a> {
    name: String,
    lines: &'a [Line],
    colour: usize,
}

/// Responses over the frequency. A line that isn't coherent breaks its curve; shades are intervals of 95 %.
#[must_use]
pub fn figure(title: &str, caption: &str, measurements: &[Shown<'_>]) -> Figure {
    let is_alone = measurements.len() == 1;
    let curves = |name: &str, of: fn(&Measured) -> &[Line]| -> Vec<Curve<'_>> {
        let curve = |(colour, shown): (usize, &Shown<'_>)| {
            let amplitude = || format!("{} {}", shown.amplitude, shown.excited.unit());
            (if is_alone { name.to_owned() } else { amplitude() }, colour)
        };
        let named = measurements.iter().enumerate().map(|it| (curve(it), it.1));
        named.map(|((name, colour), shown)| Curve { name, lines: of(shown.measured), colour }).collect()
    };
    let mut plant = curves("motor", |it| &it.motor);
    let mut load = curves("load", |it| &it.load);
    if is_alone {
        load.iter_mut().for_each(|it| it.colour = 1);
        plant.append(&mut load);
    }
    let mut figure = Figure::new(title, caption, 2);
    let is_closed = measurements.iter().any(|it| !it.measured.open_loop.is_empty());
    let (right, right_name) = if is_closed {
        (curves("open loop", |it| &it.open_loop), "Open loop")
    } else {
        (curves("closed loop", |it| &it.closed_loop), "Closed loop")
    };
    let has_right = right.iter().any(|it| !it.lines.is_empty());
    let which =
        if is_alone { "Plant, positions by torque" } else { "Plant, position of the motor by torque" };
    figure = figure.panel(magnitude(&format!("{which}: magnitude"), "dB re 1 rad/N m", &plant));
    if has_right {
        figure = figure.panel(magnitude(&format!("{right_name}: magnitude"), "dB", &right));
    }
    figure = figure.panel(phase(&format!("{which}: phase"), &plant));
    if has_right {
        figure = figure.panel(phase(&format!("{right_name}: phase"), &right));
    }
    figure = figure.panel(coherence("Coherence of the plant's response", &plant));
    if is_closed {
        figure = figure.panel(magnitude("Sensitivity", "dB", &curves("sensitivity", |it| &it.sensitivity)));
    } else if has_right {
        figure = figure.panel(coherence("Coherence of the closed loop", &right));
    }
    figure
}

fn panel(title: &str, y_axis: Axis) -> Panel {
    Panel::new(title, Axis::new("frequency", "Hz").logarithmic(), y_axis)
}

fn series(curve: &Curve<'_>, y: Vec<f64>) -> Series {
    let role = Role::Line { colour: curve.colour, dash: curve.colour / Role::COLOURS };
    Series::new(curve.name.clone(), role, curve.lines.iter().map(|it| it.frequency_hz).collect(), y)
}

/// The value of a coherent line; NaN, which breaks a curve, of any other.
fn if_coherent(line: &Line, value: f64) -> f64 {
    if line.coherence >= LEAST_COHERENCE { value } else { f64::NAN }
}

fn magnitude(title: &str, unit: &str, curves: &[Curve<'_>]) -> Panel {
    curves.iter().fold(panel(title, Axis::new("magnitude", unit)), |panel, curve| {
        let y = curve.lines.iter().map(|it| if_coherent(it, decibels(it.value.norm()))).collect();
        let within = curve.lines.iter().map(Line::within_db).collect();
        panel.series(series(curve, y).deviation(within))
    })
}

fn phase(title: &str, curves: &[Curve<'_>]) -> Panel {
    curves.iter().fold(panel(title, Axis::new("phase", "deg")), |panel, curve| {
        let mut before: Option<f64> = None;
        let y = curve.lines.iter().map(|it| {
            if it.coherence < LEAST_COHERENCE {
                return f64::NAN;
            }
            // The turn that is nearest to the line before.
            let near = before.map_or(it.phase_deg(), |before| {
                it.phase_deg() + 360.0 * ((before - it.phase_deg()) / 360.0).round()
            });
            before = Some(near);
            near
        });
        panel.series(series(curve, y.collect()))
    })
}

fn coherence(title: &str, curves: &[Curve<'_>]) -> Panel {
    curves.iter().fold(panel(title, Axis::new("coherence", "")), |panel, curve| {
        panel.series(series(curve, curve.lines.iter().map(|it| it.coherence).collect()))
    })
}
