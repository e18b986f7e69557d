//! The time from every cause to the bridge off.

use std::path::Path;
use std::time::Duration;

use crate::bench::image;
use crate::causes::{CAUSES, Cause, PERIOD};
use crate::report;

/// Instants within the period at which a cause comes, the worst of which counts.
const PHASES: [Duration; 5] = [
    Duration::ZERO,
    Duration::from_micros(170),
    Duration::from_micros(390),
    Duration::from_micros(610),
    Duration::from_micros(930),
];

fn worst(cause: &Cause) -> Duration {
    // A drive that halts comes back with a reset only.
    let phases = if cause.halts { &PHASES[1..2] } else { &PHASES[..] };
    let times = cause.times_to_off(&image(), phases);
    let times =
        times.into_iter().map(|off| off.unwrap_or_else(|| panic!("{}: the bridge stays on", cause.name)));
    times.max().expect("phases")
}

#[test]
fn every_cause_turns_the_bridge_off_within_its_time() {
    let measured: Vec<Duration> = std::thread::scope(|scope| {
        let threads: Vec<_> = CAUSES.iter().map(|cause| scope.spawn(|| worst(cause))).collect();
        threads.into_iter().map(|thread| thread.join().expect("a time")).collect()
    });
    let lines: Vec<String> = CAUSES
        .iter()
        .zip(&measured)
        .map(|(cause, off)| {
            let micros = |time: Duration| time.as_secs_f64() * 1e6;
            format!(
                "bridge off, {}: {:.1} us = {:.3} periods after {}, by {}; limit {:.0} us",
                cause.name,
                micros(*off),
                off.as_secs_f64() / PERIOD.as_secs_f64(),
                cause.from,
                cause.by,
                micros(cause.limit),
            )
        })
        .collect();
    report::write("bridge-off", &lines);
    for (cause, off) in CAUSES.iter().zip(measured) {
        assert!(off <= cause.limit, "{}: off after {off:?}, limit {:?}", cause.name, cause.limit);
    }
}

#[test]
fn the_table_of_the_docs_has_every_cause() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/bench-drive.md");
    let text = std::fs::read_to_string(path).expect("the docs");
    for Cause { name, from, by, .. } in &CAUSES {
        let row = format!("\n| {name} | {from} | {by} |");
        assert!(text.contains(&row), "no row {row:?}");
    }
}
