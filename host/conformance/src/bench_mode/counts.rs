//! The counts of the drive's encoders: where they begin, and their directions.

use super::run::{Run, allowed};
use crate::prelude::checks::*;

/// Steps under torque, so that the mechanics leave their start, and steps without it.
const MOVING: usize = 150;
const COASTING: usize = 30;
/// Runs without torque until the mechanics rest.
const MOST_WAITS: u32 = 20;
/// Pairs of runs for a direction, until both encoders show theirs: a motor on a shaft swings, and shows it where it turns back.
const MOST_PAIRS: u32 = 10;
/// Counts by which mechanics at rest may still move.
const AT_REST: i32 = 5;

pub(super) fn checks() -> Vec<Check> {
    let name = "counts are those since power-up, each in the direction of its encoder";
    vec![
        allowed("R18.14", "counts continue from run to run, and after Reset", continued),
        allowed("R18.14", name, counts),
    ]
}

/// Counts of motor and load in the first and the last step of a run without torque, and how far they drift meanwhile.
fn coast(client: &mut Client, reversed: Option<&'static str>) -> Result<[[i32; 2]; 3], Failure> {
    let least_nm = nearest_real(client.parameter(TORQUE_LIMIT_NM)?, 0.0)?;
    let mut settings = vec![(TORQUE_LIMIT_NM, F32(least_nm))];
    settings.extend(reversed.map(|name| (name, U32(1))));
    let reports = Run::start(client, &settings)?.reports(COASTING, 0.0)?;
    client.reset()?;
    let of = |place: usize| [reports[place].motor_counts.get(), reports[place].load_counts.get()];
    let (first, last) = (of(0), of(reports.len() - 1));
    Ok([first, last, [0, 1].map(|axis| (last[axis] - first[axis]).abs())])
}

/// The mechanics can't have moved faster between two runs than in the first one.
fn continued(client: &mut Client) -> RuleResult {
    let period = Duration::from_micros(client.identity.period_us.into());
    let mut is_judged = false;
    for with_reset in [false, true] {
        client.reset()?;
        let mut run = Run::start(client, &[])?;
        let timing = run.timing();
        let reports = run.reports(MOVING, 1.0)?;
        let ended = Moment::latest(run.client);
        run.client.request(Stop {})?;
        let mut run = if with_reset {
            client.reset()?;
            Run::start(client, &[])?
        } else {
            Run::again(client, timing)?
        };
        let first = run.reports(1, 1.0)?[0];
        let elapsed = ended.elapsed(run.client);
        let reported = elapsed.div_duration_f64(period * timing.every.into());
        let counts = |it: &BenchSample| [it.motor_counts, it.load_counts];
        let (start, last) = (counts(&reports[0]), counts(&reports[reports.len() - 1]));
        for axis in 0..2 {
            let moves = reports
                .windows(2)
                .map(|pair| counts(&pair[1])[axis].wrapping_sub(counts(&pair[0])[axis]).unsigned_abs());
            let fastest = f64::from(moves.max().unwrap_or(0));
            let most = 1.5 * fastest * (reported + 3.0) + f64::from(AT_REST);
            let travel = f64::from(last[axis].wrapping_sub(start[axis]).unsigned_abs());
            // What has moved little shows no new beginning.
            if travel < 3.0 * most {
                continue;
            }
            is_judged = true;
            let moved = f64::from(counts(&first)[axis].wrapping_sub(last[axis]).unsigned_abs());
            let encoder = ["motor", "load"][axis];
            let expected = format!("{encoder} counts near {} in the next run", last[axis].get());
            expect(moved <= most, expected, counts(&first)[axis].get())?;
        }
    }
    if is_judged { Ok(()) } else { skip("the mechanics at the pins move too little") }
}

fn counts(client: &mut Client) -> RuleResult {
    Run::start(client, &[])?.reports(MOVING, 1.0)?;
    client.reset()?;
    for _ in 0..MOST_WAITS {
        let [.., drift] = coast(client, None)?;
        if drift.into_iter().all(|drift| drift <= AT_REST) {
            break;
        }
    }
    let mut is_judged = false;
    for (reversed, signs) in
        [(None, [1, 1]), (Some("motor_direction"), [-1, 1]), (Some("load_direction"), [1, -1])]
    {
        let mut shows = [false; 2];
        for _ in 0..MOST_PAIRS {
            let [_, last, before] = coast(client, None)?;
            let [first, _, after] = coast(client, reversed)?;
            for axis in 0..2 {
                let (wanted, drift) = (signs[axis] * last[axis], before[axis].max(after[axis]));
                let tolerance = 3 * drift + AT_REST;
                // What rests at its start, or moves fast, has no direction that shows.
                if wanted.abs() > 2 * tolerance {
                    shows[axis] = true;
                    let encoder = ["motor", "load"][axis];
                    let direction = reversed.map_or_else(String::new, |name| format!(" with {name} reverse"));
                    let expected = format!("{encoder} counts near {wanted} in the next run{direction}");
                    expect((first[axis] - wanted).abs() <= tolerance, expected, first[axis])?;
                }
            }
            if shows == [true; 2] {
                break;
            }
        }
        is_judged |= shows.contains(&true);
    }
    if is_judged { Ok(()) } else { skip("the mechanics at the pins don't move, or never rest") }
}
