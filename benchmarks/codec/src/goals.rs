//! The performance goals of the codec, and whether this run meets them.

use crate::measure::{Figures, Length};
use crate::stream;

/// One number of several lengths of a side.
type LengthOf = fn(&Length) -> f64;

struct Goal {
    what: String,
    found: f64,
    holds: bool,
}

fn at_least(what: String, limit: f64, found: f64) -> Goal {
    Goal { what: format!("{what}: at least {limit}"), found, holds: found >= limit }
}

fn at_most(what: String, limit: f64, found: f64) -> Goal {
    Goal { what: format!("{what}: at most {limit}"), found, holds: found <= limit }
}

pub fn table(figures: &[Figures], streams: &[stream::Figures]) {
    println!("| goal | found | |\n|---|---|---|");
    for Goal { what, found, holds } in goals(figures, streams) {
        println!("| {what} | {found:.2} | {} |", if holds { "met" } else { "not met" });
    }
}

fn goals(figures: &[Figures], streams: &[stream::Figures]) -> Vec<Goal> {
    let [ours, floor, postcard, others @ ..] = figures else { panic!("at least three sides") };
    let mut goals = Vec::new();
    let tasks =
        [("sample, encode", 2.5), ("sample, decode", 3.0), ("torque, encode", 2.5), ("torque, decode", 3.0)];
    for (at, (task, faster)) in tasks.into_iter().enumerate() {
        let time = |side: &Figures| side.ns[at];
        goals.push(at_least(format!("{task}: postcard over ours"), faster, time(postcard) / time(ours)));
        let fastest = others.iter().map(time).fold(time(postcard), f64::min);
        goals.push(at_least(format!("{task}: fastest other over ours"), 1.0, fastest / time(ours)));
        goals.push(at_most(format!("{task}: ours over the floor"), 2.2, time(ours) / time(floor)));
    }
    let peers = || others.iter().chain([postcard]);
    let lengths: [(&str, LengthOf); 2] =
        [("on average", |length| length.mean), ("at most", |length| length.longest as f64)];
    for (which, len) in lengths {
        let cycle = |side: &Figures| side.bytes.iter().map(len).sum::<f64>();
        let shortest = peers().map(cycle).fold(f64::INFINITY, f64::min);
        let shortest_checked = peers().filter(|side| side.checked).map(cycle).fold(f64::INFINITY, f64::min);
        for (other, shortest) in [("other", shortest), ("other with a check", shortest_checked)] {
            let what = format!("bytes per cycle {which}: shortest {other} over ours");
            goals.push(at_least(what, 1.0, shortest / cycle(ours)));
        }
    }
    let [ours, others @ ..] = streams else { panic!("our stream") };
    for (other, (name, limit)) in
        others.iter().zip([("cobs", 1.0), ("tokio", 2.0), ("tokio with 16 tables", 2.0)])
    {
        goals.push(at_least(format!("stream, MB/s: ours over {name}"), limit, ours.mb_s() / other.mb_s()));
        let times = other.ns_per_message / ours.ns_per_message;
        goals.push(at_least(format!("stream, messages/s: ours over {name}"), limit, times));
    }
    goals
}
