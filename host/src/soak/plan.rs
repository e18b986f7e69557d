//! The scenario of each run.

use lashloop_bench::scenario::Scenario;
use lashloop_bench::scenario::fault::{EncoderFault, FaultKind, FrameFault, InjectedFault, Side, Way};

/// Share of frames that are hit, level by level. Level 0 is the scenario itself.
pub const SHARES: [f64; 6] = [0.0, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2];

/// A lost answer costs this time, so a soak does not wait long for each.
const ANSWER_TIMEOUT_MS: u32 = 100;
/// No stall of a soak lasts as long, so a drive that is silent for longer hangs.
const SILENCE_LIMIT_MS: u32 = 10_000;
/// Frames that each fault of the line hits in a run, about: each may cost an answer.
const HITS: f64 = 10.0;

/// The level of a run, counted from 0.
#[must_use]
pub fn level(run: u64) -> usize {
    (run % SHARES.len() as u64) as usize
}

/// The scenario of a run, counted from 0: that of the user with the faults of its level. Runs with faults have seeds of
/// their own, those without are the same run.
#[must_use]
pub fn scenario(of_the_user: &Scenario, run: u64) -> Scenario {
    let mut scenario = of_the_user.clone();
    scenario.link.answer_timeout_ms = ANSWER_TIMEOUT_MS;
    scenario.link.silence_limit_ms = SILENCE_LIMIT_MS;
    let level = level(run);
    if level > 0 {
        scenario.run.seed = scenario.run.seed.wrapping_add(run);
        scenario.faults.extend(faults(&scenario, level));
    }
    scenario
}

fn faults(scenario: &Scenario, level: usize) -> Vec<InjectedFault> {
    let (run, share, level) = (&scenario.run, SHARES[level], level as u32);
    let (way, duration_s, period_s) = (Way::Both, run.duration_s, run.control_period_s());
    // Two frames in a step. All of it is over before the end, so the counts of both sides are complete.
    let for_s = (HITS / (2.0 * share) * period_s).min(0.8 * duration_s);
    let fault = |at: f64, for_s: f64, kind| InjectedFault {
        at_s: at * duration_s,
        for_s: Some(for_s.min((0.95 - at) * duration_s)),
        kind,
    };
    let frame = |fault| FaultKind::Frame { fault, way };
    let steps = |count: u32| f64::from(count) * period_s;
    vec![
        fault(0.1, for_s, frame(FrameFault::BitFlip { share })),
        fault(0.1, for_s, frame(FrameFault::ByteLoss { share })),
        fault(0.1, for_s, frame(FrameFault::Duplicate { share: 10.0 * share })),
        fault(0.5, steps(20), frame(FrameFault::Delay { delay_ms: 0.2 * f64::from(level), jitter_ms: 0.5 })),
        fault(0.6, steps(level), frame(FrameFault::Stall {})),
        fault(
            0.3,
            0.3 * duration_s,
            FaultKind::Encoder { fault: EncoderFault::Noise { counts: level }, side: Side::Load },
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::soak::short_scenario::with_faults;

    #[test]
    fn every_level_is_a_scenario_that_could_stand_in_a_file() {
        for run in 0..6 {
            let scenario = scenario(&with_faults(&[]), run);
            let text = scenario.to_toml().expect("TOML");
            let read =
                Scenario::from_str(&scenario.name, &text, &[]).unwrap_or_else(|errors| panic!("{errors}"));
            assert_eq!(read, scenario);
        }
    }

    #[test]
    fn faults_rise_from_level_to_level_and_begin_anew() {
        let shares = (0..7).map(|run| {
            let scenario = scenario(&with_faults(&[]), run);
            scenario.faults.iter().find_map(|fault| match fault.kind {
                FaultKind::Frame { fault: FrameFault::BitFlip { share }, .. } => Some(share),
                _ => None,
            })
        });
        let shares: Vec<_> = shares.collect();
        assert!(shares[0].is_none() && shares[6].is_none());
        assert!(shares[1..6].is_sorted_by(|a, b| a < b), "{shares:?}");
    }

    #[test]
    fn a_run_depends_on_its_number_and_the_seed_alone_and_a_level_comes_with_other_seeds() {
        let user = with_faults(&[]);
        assert_eq!(scenario(&user, 8), scenario(&user, 8));
        assert_ne!(scenario(&user, 2).run.seed, scenario(&user, 8).run.seed);
        assert_eq!(scenario(&user, 0), scenario(&user, 6), "those without faults are the same run");
    }

    #[test]
    fn faults_of_the_user_stay_and_all_are_over_before_the_end() {
        let user = with_faults(&["kind = \"torque-dead\"\nat_s = 0.5"]);
        let scenario = scenario(&user, 5);
        assert_eq!(scenario.faults[0], user.faults[0]);
        for fault in &scenario.faults[1..] {
            assert!(fault.at_s + fault.for_s.expect("an end") <= 0.951 * user.run.duration_s, "{fault:?}");
        }
    }
}
