//! `lashloop compare`. Its measurements depend on the machine; that each is made and judged does not.

use tests::program;

const ALWAYS: [&str; 6] = [
    "lockstep: round trips, 1/s",
    "1 kHz: round trip p50, us",
    WATCHED[0],
    WATCHED[1],
    "1 kHz, recording: lateness p50, us",
    "1 kHz, live page: lateness p50, us",
];
const WATCHED: [&str; 2] = ["1 kHz, recording: round trip p50, us", "1 kHz, live page: round trip p50, us"];
/// A loop that waited for the disk or for the stuck reader would take milliseconds in place of 0.1 ms. On a shared machine
/// medians of one round differ by a factor of 2.
const MOST_SLOWED: f64 = 10.0;

fn every_measurement_is_made_and_judged(options: &[&str], judged: &[&str]) {
    let arguments = ["compare", "--rounds", "1", "--steps", "200", "--seconds", "1"];
    let ended = program::run(arguments.iter().chain(options));
    let lines: Vec<&str> = ended.stdout.lines().skip(1).collect();
    for what in ALWAYS.iter().chain(judged) {
        let line = lines.iter().find_map(|line| line.strip_prefix(what)).expect(what);
        let figures: Vec<f64> =
            line.split_whitespace().take(3).map(|figure| figure.parse().expect("a number")).collect();
        assert!(figures.iter().all(|figure| figure.is_finite() && *figure >= 0.0), "{what}: {line}");
        assert!(line.ends_with(": met") || line.ends_with(": MISSED"), "{what}: {line}");
        assert!(!WATCHED.contains(what) || figures[2] < MOST_SLOWED, "{what}: {line}");
    }
    let missed = lines.iter().any(|line| line.ends_with(": MISSED"));
    assert_eq!(ended.code, Some(i32::from(missed)), "{}{}", ended.stdout, ended.stderr);
}

#[test]
fn sleeping_loop_is_compared_with_a_sleeping_thread() {
    every_measurement_is_made_and_judged(&[], &["1 kHz: lateness p50, us", "1 kHz: lateness p99, us"]);
}

#[test]
fn busy_waiting_loop_has_an_absolute_goal() {
    every_measurement_is_made_and_judged(&["--spin-us", "50"], &["1 kHz, spinning: lateness p99, us"]);
}

#[test]
fn missing_core_is_refused() {
    let ended = program::run(["compare", "--core", "1023"]).with_code(4);
    assert!(ended.stderr.contains("can't choose a core"), "{}", ended.stderr);
}
