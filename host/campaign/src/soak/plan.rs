//! The scenario of each run.

use lashloop_bench::scenario::Scenario;
use lashloop_bench::scenario::fault::{EncoderFault, FaultKind, FrameFault, InjectedFault, Side, Way};

/// Fraction of frames hit, by level. Level 0 is the scenario itself.
pub const SHARES: [f64; 6] = [0.0, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2];

/// Answer timeout: short, since every lost answer costs this time.
const ANSWER_TIMEOUT_MS: u32 = 100;
/// Longest silence. Faults of a soak are shorter, so a drive that exceeds it hangs.
const SILENCE_LIMIT_MS: u32 = 10_000;
/// Approximate number of frames that one link fault hits per run; each may cost an answer.
const HITS: f64 = 10.0;

/// The level of a run, counted from 0.
#[must_use]
pub fn level(run: u64) -> usize {
    (run % SHARES.len() as u64) as usize
}

/// The scenario of run number `run`, from 0: the user's, with the faults of its level. Runs with faults have their own
/// seeds; runs without faults are identical.
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
    // Two frames per step. All faults end before the run does, so that the counters of both sides are complete.
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
    fn every_level_round_trips_through_toml() {
        for run in 0..6 {
            let scenario = scenario(&with_faults(&[]), run);
            let text = scenario.to_toml().expect("TOML");
            let read =
                Scenario::from_str(&scenario.name, &text, &[]).unwrap_or_else(|errors| panic!("{errors}"));
            assert_eq!(read.to_toml().expect("TOML"), text);
        }
    }

    #[test]
    fn faults_rise_from_level_to_level_and_start_over() {
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
    fn run_depends_on_number_and_seed_and_levels_repeat_with_new_seeds() {
        let user = with_faults(&[]);
        assert_eq!(scenario(&user, 8), scenario(&user, 8));
        assert_ne!(scenario(&user, 2).run.seed, scenario(&user, 8).run.seed);
        assert_eq!(scenario(&user, 0), scenario(&user, 6), "those without faults are the same run");
    }

    #[test]
    fn the_user_s_faults_stay_and_all_faults_end_before_the_run() {
        let user = with_faults(&["kind = \"torque-dead\"\nat_s = 0.5"]);
        let scenario = scenario(&user, 5);
        assert_eq!(scenario.faults[0], user.faults[0]);
        for fault in &scenario.faults[1..] {
            assert!(fault.at_s + fault.for_s.expect("an end") <= 0.951 * user.run.duration_s, "{fault:?}");
        }
    }
}
