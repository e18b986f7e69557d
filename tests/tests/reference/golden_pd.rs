//! The golden trace of the profile `pd`: it is that of the drive, and every parameter shows in it.

use lashloop_protocol::enums::TorqueFlags;

use crate::pd_trace::{LOOPS, Row, answered, parameters, path, rows, started, text};

/// The tolerance of the page, in N m.
const TOLERANCE_NM: f32 = 0.001;

#[test]
fn the_golden_trace_is_that_of_the_drive() {
    let have = std::fs::read_to_string(path()).expect("a committed file");
    let want = text();
    let differing = have.lines().zip(want.lines()).find(|(have, want)| have != want);
    assert_eq!(differing, None, "cargo run -p tests --example pd_trace writes the trace");
    assert_eq!(have.len(), want.len());
}

/// The largest difference of the torques with these parameters from those of the trace, in N m.
fn largest_difference_nm(parameters: &[(String, f64)], rows: &[Row]) -> f32 {
    let mut drive = started(parameters);
    let torques = rows.iter().map(|(sample, want)| {
        (answered(&mut drive, sample.sequence.into(), sample).torque_nm - want.torque_nm).abs()
    });
    torques.fold(0.0, f32::max)
}

#[test]
fn one_percent_of_every_parameter_shows_in_the_trace() {
    for run in &LOOPS {
        let (parameters, rows) = (parameters(run.name), rows(run));
        assert_eq!(largest_difference_nm(&parameters, &rows), 0.0, "{}", run.name);
        for (at, (name, value)) in parameters.iter().enumerate() {
            // A speed limit isn't a parameter of the law.
            if name.ends_with("speed_limit_rad_s") {
                continue;
            }
            let mut changed = parameters.clone();
            changed[at].1 = if name.contains("_counts_") || name == "period_us" {
                (0.99 * value).round()
            } else {
                0.99 * value
            };
            let difference_nm = largest_difference_nm(&changed, &rows);
            assert!(difference_nm > 2.0 * TOLERANCE_NM, "{}, {name}: {difference_nm} N m", run.name);
        }
    }
}

#[test]
fn the_trace_has_gaps_saturation_jumps_and_every_wraparound() {
    let [coarse, fine] = LOOPS.map(|run| rows(&run));
    for rows in [&coarse, &fine] {
        let flagged = |flag| rows.iter().filter(|(_, it)| it.status.flags.contains(flag)).count();
        assert_eq!(flagged(TorqueFlags::GAP), 1);
        assert!((3..30).contains(&flagged(TorqueFlags::SATURATED)));
    }
    let references = coarse.windows(2).map(|pair| (pair[1].0.reference_rad - pair[0].0.reference_rad).abs());
    assert!(references.clone().any(|moved| moved > 0.1), "a jump");
    assert!(references.clone().any(|moved| (0.009..0.02).contains(&moved)), "a large motion");
    for encoder in [|row: &Row| row.0.motor_counts.get(), |row: &Row| row.0.load_counts.get()] {
        let moved: Vec<_> = fine.windows(2).map(|pair| encoder(&pair[1]) - encoder(&pair[0])).collect();
        assert!(moved.iter().any(|moved| *moved < -(1 << 23)), "a wraparound upwards");
        assert!(moved.iter().any(|moved| *moved > 1 << 23), "a wraparound downwards");
        assert!(coarse.iter().any(|row| encoder(row) < 0), "negative readings");
    }
}
