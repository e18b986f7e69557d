//! `lashloop compare`. What it finds depends on the machine; that it finds something, and judges by it, does not.

use tests::program;

const ALWAYS: [&str; 2] = ["lockstep: round trips, 1/s", "1 kHz: round trip p50, us"];

fn every_figure_is_measured_and_judged(options: &[&str], judged: &[&str]) {
    let arguments = ["compare", "--rounds", "1", "--steps", "200", "--seconds", "1"];
    let ended = program::run(arguments.iter().chain(options));
    let lines: Vec<&str> = ended.stdout.lines().skip(1).collect();
    for what in ALWAYS.iter().chain(judged) {
        let line = lines.iter().find_map(|line| line.strip_prefix(what)).expect(what);
        let figures: Vec<f64> =
            line.split_whitespace().take(3).map(|figure| figure.parse().expect("a number")).collect();
        assert!(figures.iter().all(|figure| figure.is_finite() && *figure >= 0.0), "{what}: {line}");
        assert!(line.ends_with(": met") || line.ends_with(": MISSED"), "{what}: {line}");
    }
    let missed = lines.iter().any(|line| line.ends_with(": MISSED"));
    assert_eq!(ended.code, Some(i32::from(missed)), "{}{}", ended.stdout, ended.stderr);
}

#[test]
fn a_loop_that_sleeps_is_judged_by_a_thread_that_sleeps() {
    every_figure_is_measured_and_judged(&[], &["1 kHz: lateness p50, us", "1 kHz: lateness p99, us"]);
}

#[test]
fn a_loop_that_spins_is_judged_by_the_clock() {
    every_figure_is_measured_and_judged(&["--spin-us", "50"], &["1 kHz, spinning: lateness p99, us"]);
}

#[test]
fn a_core_that_is_not_there_is_refused() {
    let ended = program::run(["compare", "--core", "1023"]).with_code(4);
    assert!(ended.stderr.contains("can't choose a core"), "{}", ended.stderr);
}
