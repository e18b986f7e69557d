//! The expected verdict of a run, derived from its counters, independently of the code under test.

use lashloop_bench::run::{End, Outcome};
use lashloop_bench::scenario::Scenario;
use lashloop_bench::verdict::{LinkCounts, Verdict};

/// The contradiction between the verdict and the counters of a lockstep run, if any.
#[must_use]
pub fn wrong(scenario: &Scenario, outcome: &Outcome) -> Option<String> {
    let Outcome { judgement, end, link, .. } = outcome;
    let (allow, have) = (&scenario.allow, judgement.verdict);
    let beyond = [
        (link.lost, allow.lost),
        (link.late, allow.late),
        (link.crc_errors, allow.crc_errors),
        (link.resumes, allow.resumes),
    ];
    let slow = allow.round_trip_p99_us.is_some_and(|allowed| {
        outcome.timing.round_trip_us.is_none_or(|round_trip| round_trip.p99.ceil() > allowed as f64)
    });
    let broken = slow || beyond.iter().any(|(counted, allowed)| counted > allowed);
    let met = judgement.expectations.iter().all(|finding| {
        let value = finding.value.value().unwrap_or(f64::NAN);
        let (min, max) = (finding.min.unwrap_or(f64::MIN), finding.max.unwrap_or(f64::MAX));
        (min..=max).contains(&value)
    });
    let want = match end.verdict() {
        _ if end.broken_rule().is_some() => Verdict::Fail,
        _ if broken => Verdict::Invalid,
        Some(Verdict::Invalid) => Verdict::Invalid,
        None if met => Verdict::Pass,
        _ => Verdict::Fail,
    };
    if have != want {
        return Some(format!(
            "{have} instead of {want}: {} of {link:?}, ended {end}",
            judgement.expectations.len()
        ));
    }
    uncounted(outcome)
}

/// In a complete run, one of the two sides counts every damaged frame.
fn uncounted(outcome: &Outcome) -> Option<String> {
    let damaging = ["link-bit-flip", "link-byte-loss"];
    let hits: u64 = (outcome.faults.iter())
        .filter(|fault| damaging.contains(&&*fault.kind))
        .filter_map(|fault| fault.frames)
        .sum();
    let LinkCounts { crc_errors, damaged_at_drive, .. } = outcome.link;
    let is_counted = crc_errors + damaged_at_drive > 0 || hits == 0;
    (outcome.end == End::Complete && !is_counted)
        .then(|| format!("{hits} frames were damaged and none was counted"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::soak::short_scenario::{one_step, with_faults};
    use lashloop_bench::fault::timeline::FaultRecord;

    fn outcome(verdict: Verdict, link: LinkCounts) -> Outcome {
        Outcome { link, ..one_step(verdict) }
    }

    fn wrong_with(outcome: &Outcome) -> Option<String> {
        wrong(&with_faults(&[]), outcome)
    }

    #[test]
    fn pass_with_more_losses_than_allowed_is_wrong() {
        let counts = [
            LinkCounts { lost: 1, ..LinkCounts::default() },
            LinkCounts { late: 1, ..LinkCounts::default() },
            LinkCounts { crc_errors: 1, ..LinkCounts::default() },
            LinkCounts { resumes: 1, ..LinkCounts::default() },
        ];
        for link in counts {
            assert!(wrong_with(&outcome(Verdict::Pass, link)).is_some(), "{link:?}");
            assert!(wrong_with(&outcome(Verdict::Fail, link)).is_some(), "{link:?}");
            assert_eq!(wrong_with(&outcome(Verdict::Invalid, link)), None);
        }
    }

    #[test]
    fn invalid_or_fail_without_a_cause_is_wrong() {
        assert_eq!(wrong_with(&outcome(Verdict::Pass, LinkCounts::default())), None);
        assert!(wrong_with(&outcome(Verdict::Invalid, LinkCounts::default())).is_some());
        assert!(wrong_with(&outcome(Verdict::Fail, LinkCounts::default())).is_some());
    }

    #[test]
    fn pass_of_a_run_that_ended_early_is_wrong() {
        let run = Outcome { end: End::DriveRestarted, ..outcome(Verdict::Pass, LinkCounts::default()) };
        assert!(wrong_with(&run).is_some());
    }

    #[test]
    fn uncounted_damage_is_wrong() {
        let hit = FaultRecord { kind: "link-bit-flip".into(), step: 0, until_step: Some(9), frames: Some(3) };
        let run = Outcome { faults: vec![hit], ..outcome(Verdict::Pass, LinkCounts::default()) };
        assert!(wrong_with(&run).is_some_and(|why| why.contains("none was counted")));
        let at_drive = LinkCounts { damaged_at_drive: 3, ..LinkCounts::default() };
        assert_eq!(wrong_with(&Outcome { link: at_drive, ..run }), None);
    }
}
