//! `lashloop paper experiment`: simulation and experiment side by side.

use std::fs;

use tests::program;
use tests::records::Records;

#[test]
fn the_experiment_is_compared_with_its_simulation() {
    let records = Records::new();
    let ended =
        program::run(["paper", "experiment", "--device", "inproc", "--out", &records.out()]).with_code(0);
    assert_eq!(ended.stdout.matches("simulation PASS, experiment PASS").count(), 4, "{}", ended.stdout);
    let row = |name: &str| {
        let row =
            ended.stdout.lines().find(|line| line.starts_with(name)).unwrap_or_else(|| panic!("{name}"));
        row.split("  ").map(str::trim).filter(|cell| !cell.is_empty()).skip(1).collect::<Vec<_>>()
    };
    assert_eq!(row("smooth: time into")[0], "about 13");
    let numbers =
        |name: &str| -> Vec<f64> { row(name).iter().filter_map(|cell| cell.parse().ok()).collect() };
    for name in ["smooth: time into", "friction: static error", "smooth: rms torque"] {
        let [simulated_before, before, simulated_after, after] = numbers(name)[..] else { panic!("{name}") };
        for (simulation, experiment) in [(simulated_before, before), (simulated_after, after)] {
            let near = 0.02 * simulation.abs() + 0.002;
            assert!((simulation - experiment).abs() <= near, "{name}: {simulation} and {experiment}");
        }
    }
    let gap = row("estimate of the gap");
    assert_eq!((gap[2], gap[5]), ("not measured on a bench", "not measured on a bench"));
    for number in ["07", "15", "16", "17"] {
        let svg = fs::read_to_string(records.path(&format!("figure-{number}.svg"))).expect("a figure");
        let document = roxmltree::Document::parse(&svg).expect("well-formed XML");
        let text: String = document.descendants().filter_map(|node| node.text()).collect();
        assert!(text.contains("experiment") && text.contains("no truth"), "figure {number}: {text}");
    }
    let page = fs::read_to_string(records.path("index.html")).expect("the page");
    assert!(page.contains("<title>Simulation and experiment</title>"));
}

#[test]
fn nobody_moves_a_load_for_a_drive_without_pins() {
    let ended = program::run(["paper", "experiment", "--device", "native", "--out", &Records::new().out()])
        .with_code(4);
    assert!(ended.stderr.contains("no parameter sample_source"), "{}", ended.stderr);
    assert!(!ended.stdout.contains("bring the load"), "{}", ended.stdout);
}
