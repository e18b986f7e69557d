//! `lashloop compare`. What it finds depends on the machine; that it finds something, and judges by it, does not.

use tests::bench;

#[test]
fn every_figure_of_both_sides_is_measured_and_judged() {
    let arguments = ["compare", "--rounds", "1", "--steps", "200", "--seconds", "1", "--spin-us", "50"];
    let ended = bench::run(arguments);
    let lines: Vec<&str> = ended.stdout.lines().skip(1).collect();
    let judged = [
        "lockstep: round trips, 1/s",
        "1 kHz: lateness p50, us",
        "1 kHz: lateness p99, us",
        "1 kHz: round trip p50, us",
        "1 kHz, spinning: lateness p99, us",
    ];
    for what in judged {
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
fn a_core_that_is_not_there_is_refused() {
    let ended = bench::run(["compare", "--core", "1023"]).with_code(4);
    assert!(ended.stderr.contains("can't choose a core"), "{}", ended.stderr);
}
