//! The paper's numbers, by the program alone.

use std::fmt::Write;

use tests::paper::RUNS;

#[test]
fn four_runs_of_the_paper_in_process_and_on_the_twin() {
    let mut table = format!(
        "{:<16} {:<7} {:>7} {:>9} {:>10} {:>12} {:>11} {:>7}\n",
        "scenario", "device", "verdict", "settle s", "static rad", "overshoot rad", "hunting rad", "steps"
    );
    for run in RUNS {
        for device in ["inproc", "native"] {
            let summary = run.pass_on(device);
            let metric = |name: &str, digits: usize| {
                let value = summary["metrics"][name].as_f64();
                value.map_or_else(|| "none".to_owned(), |value| format!("{value:.digits$}"))
            };
            writeln!(
                table,
                "{:<16} {device:<7} {:>7} {:>9} {:>10} {:>12} {:>11} {:>7}",
                run.name,
                summary["verdict"].as_str().unwrap_or("none"),
                metric("settle_time_s", 2),
                metric("static_error_rad", 4),
                metric("overshoot_rad", 3),
                metric("hunting_rad", 3),
                summary["steps"],
            )
            .expect("writing to a string");
        }
    }
    insta::assert_snapshot!(table);
}
