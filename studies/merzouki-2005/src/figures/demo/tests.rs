//! The figure of the demo.

use roxmltree::Document;

use super::{DemoRuns, before_after};
use crate::figures::{Laws, Run};
use lashloop_plant::Signal;
use lashloop_plant::metrics::{Measurement, Sample, SignalTable};
use lashloop_record::columns::Columns;
use lashloop_record::trace::columns;

const SAMPLES: usize = 25_000;

/// Noise that differs from sample to sample by far more than a pixel.
fn noise(sample: usize) -> f64 {
    (sample.wrapping_mul(2_654_435_761) % 1_000) as f64 / 1_000.0
}

fn texts<'a>(document: &'a Document) -> Vec<&'a str> {
    document.descendants().filter(|node| node.has_tag_name("text")).filter_map(|node| node.text()).collect()
}

/// The curves decay; the metrics are those of a load that settles at `settle_time_s` and rests at `static_error_rad`.
fn demo_run(settle_time_s: Option<f64>, static_error_rad: f64) -> Run {
    let drive = ["dead_zone_estimate_rad", "dead_zone_deviation_rad"].map(|name| Signal::new(name, "rad"));
    let signals = SignalTable { plant: Vec::new(), drive: drive.to_vec() };
    let mut measurement = Measurement::new(1e-3, &signals);
    let mut trace = Columns::new(columns(&signals));
    for sample in 0..SAMPLES {
        let time_s = sample as f64 * 1e-3;
        let load_position_rad = static_error_rad + 1.57 * (-time_s).exp();
        let (torque_nm, estimate_rad) = (20.0 * noise(sample) - 10.0, 0.16 + 0.1 * noise(sample));
        trace.push([
            time_s,
            0.0,
            load_position_rad,
            0.0,
            torque_nm,
            estimate_rad,
            0.04,
            time_s,
            0.0,
            0.0,
            0.0,
        ]);
        let is_settled = settle_time_s.is_none_or(|settle_s| time_s >= settle_s);
        measurement.push(&Sample {
            time_s,
            reference_rad: 0.0,
            load_position_rad: if is_settled { static_error_rad } else { 1.0 },
            motor_position_rad: 0.0,
            torque_nm: 0.0,
            plant: &[],
            drive: None,
        });
    }
    Run { trace, metrics: measurement.metrics() }
}

fn demo_runs() -> DemoRuns {
    DemoRuns {
        smooth: Laws {
            before: demo_run(Some(12.904), 0.0),
            after: demo_run(Some(5.137), 0.0),
            beyond: demo_run(Some(1.091), -0.003),
        },
        friction: Laws {
            before: demo_run(None, 0.32),
            after: demo_run(Some(6.45), -0.0088),
            beyond: demo_run(Some(1.127), 0.0015),
        },
        dead_zone_rad: 0.16,
    }
}

#[test]
fn figure_of_25_000_noisy_samples_stays_below_300_kilobytes() {
    let svg = before_after(&demo_runs()).to_svg();
    assert!(svg.len() < 300_000, "{} bytes", svg.len());
    Document::parse(&svg).expect("valid XML");
}

#[test]
fn our_numbers_stand_next_to_the_paper_s() {
    let svg = before_after(&demo_runs()).to_svg();
    let document = Document::parse(&svg).expect("valid XML");
    let texts = texts(&document);
    for label in [
        "12.9 s (paper: 13 s)",
        "5.1 s (paper: 5.2 s)",
        "0.320 rad (paper: 0.32 rad)",
        "\u{2212}0.009 rad (paper: eliminated)",
        "1.1 s",
        "0.002 rad",
    ] {
        assert!(texts.contains(&label), "{label} is missing in {texts:?}");
    }
    let mut never = demo_runs();
    never.smooth.after = demo_run(None, 0.1);
    assert!(before_after(&never).to_svg().contains("never settles (paper: 5.2 s)"));
}

/// Names of the curves drawn, one for each time that it is drawn.
fn curves<'a>(document: &'a Document) -> Vec<&'a str> {
    let paths = document.descendants().filter(|node| node.has_tag_name("path"));
    paths.filter_map(|path| path.first_element_child()?.text()).collect()
}

#[test]
fn each_panel_draws_the_law_beyond_the_paper() {
    let svg = before_after(&demo_runs()).to_svg();
    let document = Document::parse(&svg).expect("valid XML");
    let curves = curves(&document);
    let drawn = |name| curves.iter().filter(|curve| **curve == name).count();
    let beyond = "beyond the paper: braking-curve";
    assert_eq!([drawn("before: PD"), drawn("after: compensation"), drawn(beyond)], [3; 3], "{curves:?}");
    assert_eq!(drawn("braking-curve \u{b1} deviation, with friction"), 1, "{curves:?}");
    assert!(texts(&document).contains(&beyond), "the legend names it");
}

#[test]
fn panel_of_the_estimate_says_what_drives_it_and_shades_the_deviation() {
    let svg = before_after(&demo_runs()).to_svg();
    let document = Document::parse(&svg).expect("valid XML");
    let end_rad = format!("{:.2} rad", 0.16 + 0.1 * noise(SAMPLES - 1));
    for label in [format!("{end_rad}: load friction taken for gap"), format!("{end_rad} \u{b1} 0.04 rad")] {
        assert!(texts(&document).contains(&&*label), "{label} is missing in {:?}", texts(&document));
    }
    let shades = document.descendants().filter(|node| node.has_attribute("fill-opacity")).count();
    assert_eq!(shades, 2, "the shade and its sample in the legend");
}

#[test]
fn runs_without_samples_still_give_a_figure() {
    let nothing =
        Run { trace: Columns::default(), metrics: Measurement::new(1e-3, &SignalTable::default()).metrics() };
    let plant = Laws { before: nothing.clone(), after: nothing.clone(), beyond: nothing };
    let svg =
        before_after(&DemoRuns { smooth: plant.clone(), friction: plant, dead_zone_rad: 0.16 }).to_svg();
    Document::parse(&svg).expect("valid XML");
}
