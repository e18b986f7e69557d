//! Samples later than the watchdog allows.

use super::timing::{CLOCK_TOLERANCE, LONGEST_ATTEMPT, QUICK, start_with, too_busy};
use crate::prelude::checks::*;
use crate::reactions::zero_torque;

/// A watchdog for samples that come late.
const SHORT: Duration = Duration::from_millis(20);
/// Further lateness of each attempt with a late sample, as a fraction of the watchdog.
const LATER: f64 = 0.5;

/// A new, a repeated and a stray sample, later than the watchdog allows.
pub(super) fn late_samples(client: &mut Client) -> RuleResult {
    let last = QUICK - 1;
    for late in [QUICK, last, 5000] {
        let mut ended = Late::Untimely;
        for attempt in 0..=LONGEST_ATTEMPT {
            client.reset()?;
            ended = late_sample(client, late, last, attempt)?;
            if ended == Late::Answered {
                break;
            }
        }
        match ended {
            Late::Answered => {}
            Late::Untimely => return Err(too_busy()),
            Late::Running => return Err(broken("a FaultReport for a late sample", "an answer in Running")),
            Late::After => return Err(broken("the TorqueAnswer of a late sample first", "the FaultReport")),
        }
    }
    Ok(())
}

/// What became of a late sample.
#[derive(Clone, Copy, PartialEq)]
enum Late {
    /// Answered, and then reported.
    Answered,
    /// Reported just before it arrived, so the report does not answer it.
    After,
    /// Answered as in time.
    Running,
    /// It wasn't late, or the samples before it were late too.
    Untimely,
}

/// The drive's own clock decides whether a sample is late, if the drive has one: that of an emulator on a busy machine lags behind.
fn late_sample(client: &mut Client, late: u16, last: u16, attempt: u32) -> Result<Late, Failure> {
    start_with(client, SHORT)?;
    for sequence in 1..QUICK {
        client.torque(sequence)?;
    }
    client.request_bytes(&[])?;
    if client.state != Running {
        return Ok(Late::Untimely);
    }
    let (from_us, mut reports) = (client.arrivals.device_us, Vec::new());
    // Without a clock to ask, each attempt is later than the last.
    let lateness = SHORT.mul_f64(2.0 * CLOCK_TOLERANCE + LATER * f64::from(attempt));
    client.wait_for(SHORT + lateness, |message| {
        reports.extend(of::<FaultReport>(message));
        None::<()>
    })?;
    reports.extend(client.request_bytes(&[])?.iter().filter_map(of::<FaultReport>));
    let passed_us = from_us.zip(client.arrivals.device_us).map(|(from, to)| to.wrapping_sub(from));
    let answers = client.request(sample(late))?;
    reports.extend(answers.iter().filter_map(of::<FaultReport>));
    if reports.is_empty() && client.state == Running {
        let Some(passed_us) = passed_us else { return Ok(Late::Running) };
        let limit_us = SHORT.as_micros() as u32;
        let expected =
            format!("for the late sample {late}, after {passed_us} us of device time, a FaultReport");
        expect(passed_us <= limit_us, expected, "an answer in Running")?;
        return Ok(Late::Untimely);
    }
    let expected = format!("for the late sample {late} one FaultReport");
    expect(reports.len() == 1, expected, reports.as_slice())?;
    let got = (reports[0].code, reports[0].sequence);
    equal("code and sequence", (FaultCode::Watchdog, last), got)?;
    zero_torque(late, Faulted, &answers)?;
    Ok(if names(&answers)[0] == "TorqueAnswer" { Late::Answered } else { Late::After })
}
