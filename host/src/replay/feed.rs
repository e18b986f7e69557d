//! The samples sent, the answers compared.

use std::time::Duration;

use lashloop_bench::device::Device;
use lashloop_bench::run::setup::lockstep_watchdog;
use lashloop_bench::scenario::sections::LinkSettings;
use lashloop_link::TimeBase;
use lashloop_record::diff::Tolerance;
use lashloop_record::manifest::ParameterInForce;
use lashloop_session::Exchange;

use super::error::ReplayError;
use super::parameters::apply;
use super::recording::Recording;
use super::report::{DriveEnd, Replay};

/// Sends the samples of a recording to a device in lockstep and compares its torques. `stop_asked` is polled in every step.
///
/// # Errors
/// The firmware lacks a parameter, or device or link failed.
pub fn replay(
    recording: &Recording,
    parameters: &[ParameterInForce],
    link: &LinkSettings,
    tolerance: Option<Tolerance>,
    device: &mut Device,
    stop_asked: impl Fn() -> bool,
) -> Result<Replay, ReplayError> {
    device.session.line.set_time_base(TimeBase::Virtual);
    device.session.reset().map_err(|source| device.explain(source))?;
    let watchdog = lockstep_watchdog(&device.connection.host, link.silence_limit());
    apply(parameters, device, watchdog)?;
    device.session.start().map_err(|source| device.explain(source))?;
    let mut replay = Replay::new(recording, tolerance);
    for (index, recorded) in recording.steps.iter().enumerate() {
        if stop_asked() {
            replay.end = Some(DriveEnd::Interrupted);
            break;
        }
        // The first sample of a drive has number 0, also where only a later copy of it was answered.
        let number = if index == 0 { 0 } else { recorded.step - recording.origin };
        let timeout: Duration = link.answer_timeout();
        let deadline = device.session.line.now() + timeout;
        match device.session.exchange(number, &recorded.sample, deadline) {
            Ok(Exchange::Answered(answer)) => replay.push(recorded, answer.torque_nm),
            Ok(Exchange::Faulted(fault)) => {
                replay.end = Some(DriveEnd::Fault { step: recorded.step, report: *fault });
                break;
            }
            Ok(Exchange::Unanswered | Exchange::Rejected) => {
                let silent = device.session.line.silent("EncoderSample", timeout);
                device.session.abandon();
                return Err(device.explain(silent).into());
            }
            Err(source) => {
                device.session.abandon();
                return Err(device.explain(source).into());
            }
        }
    }
    device.session.stop().map_err(|source| device.explain(source))?;
    Ok(replay)
}
