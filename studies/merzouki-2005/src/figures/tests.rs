//! The paper's figures, from synthetic runs.

use std::f64::consts::FRAC_PI_2;

use roxmltree::Document;

use super::hysteresis::thickness;
use super::{Laws, PAPER, Run, Runs, Table, figures, page, tables};
use lashloop_plant::Signal;
use lashloop_plant::metrics::{Measured, Measurement, Sample, SignalTable};
use lashloop_record::columns::Columns;
use lashloop_record::trace::columns;

/// Counts and reference as sent, which no figure shows.
const SENT: [f64; 3] = [0.0; 3];
const PERIOD_S: f64 = 0.001;

/// The signals of the synthetic runs: those of a plant with a gap, and those of a law with an estimator.
fn signals() -> SignalTable {
    let signals = |list: &[(&'static str, &'static str)]| {
        list.iter().map(|(name, unit)| Signal::new(name, unit)).collect()
    };
    SignalTable {
        plant: signals(&[
            ("load_velocity_rad_s", "rad/s"),
            ("motor_velocity_rad_s", "rad/s"),
            ("twist_rad", "rad"),
            ("transmitted_torque_nm", "N m"),
            ("dead_zone_rad", "rad"),
            ("disturbing_torque_nm", "N m"),
        ]),
        drive: signals(&[
            ("dead_zone_estimate_rad", "rad"),
            ("disturbing_torque_estimate_nm", "N m"),
            ("motor_error_rad", "rad"),
        ]),
    }
}

/// A load that decays from pi/2 to `rest_rad`, with a twist of three times the error. The drive sends telemetry with every
/// tenth step.
fn run(seconds: f64, rest_rad: f64) -> Run {
    let signals = signals();
    let mut measurement = Measurement::new(PERIOD_S, &signals);
    let mut trace = Columns::new(columns(&signals));
    for step in 0..(seconds / PERIOD_S).round() as u32 {
        let time_s = f64::from(step) * PERIOD_S;
        let load_position_rad = rest_rad + (FRAC_PI_2 - rest_rad) * (-time_s).exp();
        let telemetry_s = f64::from(step - step % 10) * PERIOD_S;
        let fixed = [time_s, 0.0, load_position_rad, 3.0 * FRAC_PI_2, -1.0];
        let plant = [0.0, 0.0, 3.0 * load_position_rad, 2.0 * load_position_rad, 0.16, -load_position_rad];
        let drive = [0.16, 0.0, load_position_rad];
        trace.push(fixed.into_iter().chain(plant).chain(drive).chain([telemetry_s]).chain(SENT));
        measurement.push(&Sample {
            time_s,
            reference_rad: 0.0,
            load_position_rad,
            motor_position_rad: 3.0 * FRAC_PI_2,
            torque_nm: -1.0,
            plant: &plant,
            drive: (step % 10 == 0).then_some(&drive[..]),
        });
    }
    Run { trace, metrics: measurement.metrics() }
}

fn runs(seconds: f64) -> Runs {
    let laws = |rests: [f64; 3]| {
        let [before, after, beyond] = rests.map(|rest_rad| run(seconds, rest_rad));
        Laws { before, after, beyond }
    };
    let gap = run(seconds, 0.0).trace;
    Runs {
        smooth: laws([0.03, 0.0, 0.002]),
        friction: laws([0.32, -0.0087, 0.0019]),
        shaft: laws([0.32, -0.0079, 0.0014]),
        sine: laws([0.3, 0.0, 0.0]),
        smooth_gap: gap.clone(),
        hard_gap: gap,
        ratio: 3.0,
    }
}

#[test]
fn every_figure_shows_all_laws_and_states_our_result() {
    let figures = figures(&runs(25.0));
    let numbers: Vec<u8> = figures.iter().map(|(number, _)| *number).collect();
    assert_eq!(numbers, [5, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17]);
    for (number, figure) in &figures {
        assert!(figure.title.starts_with(&format!("Figure {number}: ")), "{}", figure.title);
        assert!(
            figure.caption.starts_with("The paper: ") && figure.caption.contains("\nHere: "),
            "figure {number}: {}",
            figure.caption
        );
        for panel in &figure.panels {
            let drawn = panel.series.iter().filter(|series| series.y.iter().any(|y| y.is_finite()));
            assert!(drawn.count() >= 3, "figure {number}, {}", panel.title);
            assert!(!panel.y_axis.unit.is_empty() && !panel.x_axis.unit.is_empty(), "figure {number}");
        }
        let svg = figure.to_svg();
        Document::parse(&svg).unwrap_or_else(|error| panic!("figure {number}: {error}"));
        assert!(svg.len() < 100_000, "figure {number}: {} bytes", svg.len());
    }
}

#[test]
fn estimates_are_drawn_at_the_steps_of_their_telemetry() {
    let figures = figures(&runs(2.0));
    let (_, made_linear) = figures.iter().find(|(number, _)| *number == 14).expect("figure 14");
    let over_twist = &made_linear.panels[0].series[0];
    assert_eq!(over_twist.x.len(), 200, "a point for every tenth of 2000 steps");
    assert!(over_twist.x.iter().zip(&over_twist.y).all(|(z, c)| (c - 2.0 / 3.0 * z).abs() < 1e-12));
    let line = made_linear.panels[0].series.last().expect("C0");
    assert!(line.x.iter().zip(&line.y).all(|(z, c0)| (c0 - z).abs() < 1e-12), "{line:?}");
}

#[test]
fn runs_without_a_step_still_give_figures_and_tables() {
    let mut nothing = runs(0.0);
    (nothing.smooth_gap, nothing.hard_gap) = (Columns::default(), Columns::default());
    for (number, figure) in figures(&nothing) {
        let svg = figure.to_svg();
        Document::parse(&svg).unwrap_or_else(|error| panic!("figure {number}: {error}"));
        assert!(!svg.contains("NaN") && !svg.contains("inf "), "figure {number}");
    }
    let text = tables(&nothing).map(|table| table.to_string()).join("\n");
    assert!(text.contains("run too short") && !text.contains("NaN"), "{text}");
}

#[test]
fn thickness_of_a_loop_is_the_range_of_the_twist_at_the_load() {
    let mut trace = Columns::new(vec![Signal::new("twist_rad", "rad")]);
    [0.5, -1.0, 0.25].into_iter().for_each(|twist_rad| trace.push([twist_rad]));
    let run = Run { trace, ..run(1.0, 0.0) };
    assert_eq!(thickness(&run, 3.0), Measured::Value(0.5));
}

#[test]
fn table_columns_are_aligned() {
    let row = |what: &str, cells: [&str; 2]| (what.to_owned(), cells.map(str::to_owned).to_vec());
    let table = Table {
        title: "numbers",
        columns: vec!["paper", "here"],
        rows: vec![row("time (s)", ["about 13", "12.90"]), row("error (rad)", ["-", "-0.0087"])],
    };
    insta::assert_snapshot!(table.to_string(), @r"
    numbers
                    paper     here
    time (s)     about 13    12.90
    error (rad)         -  -0.0087
    ");
}

#[test]
fn page_holds_every_figure_once_and_is_self_contained() {
    let runs = runs(1.0);
    let figures = figures(&runs);
    let page = page(&PAPER, &figures, &tables(&runs), "drawn on <dev> & more");
    assert!(page.contains("drawn on &lt;dev&gt; &amp; more"));
    for (number, figure) in &figures {
        assert_eq!(page.matches(&figure.to_svg()).count(), 1, "figure {number}");
        assert!(page.contains(&format!("href=\"#figure-{number:02}\"")), "figure {number}");
        assert!(page.contains(&format!("href=\"figure-{number:02}.svg\"")), "figure {number}");
    }
    assert!(!page.contains("src=") && !page.contains("<script") && !page.contains("@import"));
}

#[test]
fn a_drive_without_an_estimator_leaves_its_panels_empty() {
    let mut runs = runs(1.0);
    for run in [&mut runs.smooth.before, &mut runs.smooth.after, &mut runs.smooth.beyond] {
        let mut trace = Columns::new(columns(&SignalTable { drive: Vec::new(), ..signals() }));
        trace.push([0.0; 15]);
        run.trace = trace;
    }
    let figures = figures(&runs);
    let (_, made_linear) = figures.iter().find(|(number, _)| *number == 14).expect("figure 14");
    let curves = |panel: usize| made_linear.panels[panel].series.iter().take(3);
    assert!(curves(0).all(|series| series.y.iter().all(|y| y.is_nan())), "{:?}", made_linear.panels[0]);
    assert!(curves(1).any(|series| series.y.iter().any(|y| y.is_finite())));
}
