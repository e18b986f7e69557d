//! What every check of the watchdog needs: a run with a short one, its report, and the limits of a fair judgement.

use std::time::Duration;

use lashloop_protocol::DriveMessage;
use lashloop_protocol::enums::ParameterValue;
use lashloop_protocol::message::FaultReport;

use super::super::assertion::{Failure, RuleResult};
use super::super::client::Client;
use super::super::reactions::first_sample;

pub(super) const NAME: &str = "watchdog_us";
/// Tolerated error of the drive's clock, as a fraction.
pub(super) const CLOCK_TOLERANCE: f64 = 0.1;
/// Samples in quick succession before those whose time counts.
pub(super) const QUICK: u16 = 10;
/// Last attempt with samples at a time, from 0.
pub(super) const LONGEST_ATTEMPT: u32 = 4;

pub(super) fn micros(time: Duration) -> ParameterValue {
    ParameterValue::U32(time.as_micros() as u32)
}

/// Starts a run with this watchdog and sends the first sample.
pub(super) fn start_with(client: &mut Client, watchdog: Duration) -> RuleResult {
    client.idle()?;
    client.put(NAME, micros(watchdog))?;
    client.arm_if_consistent()?;
    client.start()?;
    first_sample(client).map(drop)
}

pub(crate) fn fault_report(message: &DriveMessage) -> Option<FaultReport> {
    match message {
        DriveMessage::FaultReport(it) => Some(*it),
        _ => None,
    }
}

pub(super) fn too_busy() -> Failure {
    Failure::NotJudged { cause: "this machine is too busy to send samples in time".to_owned() }
}
