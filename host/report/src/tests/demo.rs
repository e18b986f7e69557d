//! The figure of the demo.

use roxmltree::Document;

use super::{SAMPLES, noise, texts, times};
use crate::demo::{DemoRun, DemoRuns, PlantRuns, before_after};

fn demo_run(settle_time_s: Option<f64>, static_error_rad: f64) -> DemoRun {
    let decay = |sample: usize| static_error_rad + 1.57 * (-(sample as f64) * 1e-3).exp();
    DemoRun {
        time_s: times(),
        load_position_rad: (0..SAMPLES).map(decay).collect(),
        torque_nm: (0..SAMPLES).map(|sample| 20.0 * noise(sample) - 10.0).collect(),
        dead_zone_estimate_rad: (0..SAMPLES).map(|sample| 0.16 + 0.1 * noise(sample)).collect(),
        settle_time_s,
        static_error_rad,
    }
}

fn demo_runs() -> DemoRuns {
    DemoRuns {
        smooth: PlantRuns { before: demo_run(Some(12.904), 0.0), after: demo_run(Some(5.137), 0.0) },
        friction: PlantRuns { before: demo_run(None, 0.32), after: demo_run(Some(6.45), -0.0088) },
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
    ] {
        assert!(texts.contains(&label), "{label} is missing in {texts:?}");
    }
    let mut never = demo_runs();
    never.smooth.after.settle_time_s = None;
    assert!(before_after(&never).to_svg().contains("never settles (paper: 5.2 s)"));
}

#[test]
fn runs_without_samples_still_give_a_figure() {
    let nothing = DemoRun {
        time_s: vec![],
        load_position_rad: vec![],
        torque_nm: vec![],
        dead_zone_estimate_rad: vec![],
        settle_time_s: Some(1.0),
        static_error_rad: f64::NAN,
    };
    let plant = PlantRuns { before: nothing.clone(), after: nothing };
    let svg =
        before_after(&DemoRuns { smooth: plant.clone(), friction: plant, dead_zone_rad: 0.16 }).to_svg();
    Document::parse(&svg).expect("valid XML");
}
