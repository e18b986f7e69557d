//! What every check of the watchdog needs: a run with a short one, its report, and the limits of a fair judgement.

use super::super::judge::ATTEMPTS;
use crate::prelude::checks::*;

/// Tolerated error of the drive's clock, as a fraction.
pub(super) const CLOCK_TOLERANCE: f64 = 0.1;
/// Samples in quick succession before those whose time counts.
pub(super) const QUICK: u16 = 10;
/// Slowest answer, and greatest lateness of the bench, with which the times of these checks hold.
const SLOWEST_ANSWER: Duration = Duration::from_millis(8);
/// As above, for what must happen within a second. Shorter than every watchdog of these checks.
const SLOWEST_OF_ALL: Duration = Duration::from_millis(30);
/// Last attempt with samples at a time, from 0.
pub(super) const LONGEST_ATTEMPT: u32 = 4;

pub(super) fn micros(time: Duration) -> ParameterValue {
    U32(time.as_micros() as u32)
}

/// Starts a run with this watchdog and sends the first sample.
pub(super) fn start_with(client: &mut Client, watchdog: Duration) -> RuleResult {
    client.idle()?;
    client.put(WATCHDOG_US, micros(watchdog))?;
    client.arm_if_consistent()?;
    client.start()?;
    first_sample(client).map(drop)
}

pub(super) fn too_busy() -> Failure {
    Failure::NotJudged { cause: "this machine is too busy to send samples in time".to_owned() }
}

/// Tries a check again that fails while an answer comes late or the bench itself is late: the drive can't tell when the bench
/// has sent a sample, and the bench not when the drive has processed it.
pub(crate) fn in_time(check: Check) -> Check {
    judged_up_to(SLOWEST_ANSWER, check)
}

/// As [`in_time`], for a check of what must happen at all.
pub(crate) fn nearly_in_time(check: Check) -> Check {
    judged_up_to(SLOWEST_OF_ALL, check)
}

fn judged_up_to(slowest: Duration, Check { rules, name, run }: Check) -> Check {
    check(rules, name, move |client| {
        for _ in 0..ATTEMPTS {
            client.slowest = Duration::ZERO;
            let ended = run(client);
            let is_broken = matches!(ended, Err(Failure::Rule { .. } | Failure::Preparation { .. }));
            if !is_broken || client.slowest <= slowest {
                return ended;
            }
            client.is_unsettled = true;
            client.reset()?;
        }
        let longest_ms = client.slowest.as_millis();
        let cause =
            format!("an answer or the bench is up to {longest_ms} ms late, too long to time a watchdog");
        Err(Failure::NotJudged { cause })
    })
}
