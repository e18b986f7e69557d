//! The samples of a record as they were sent, and the torques that answered them.

use lashloop_protocol::EncoderCounts;
use lashloop_protocol::message::EncoderSample;
use lashloop_record::diff::RecordFiles;
use lashloop_record::reader::Record;

use super::error::ReplayError;

/// Columns of the samples as they were sent.
const MOTOR_COUNTS: &str = "motor_counts";
const LOAD_COUNTS: &str = "load_counts";
const REFERENCE: &str = "sent_reference_rad";

/// The samples of a run, from its start.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Recording {
    /// The steps that sent a sample, ascending, from the first that was answered. A missed step sent none.
    pub steps: Vec<RecordedStep>,
    /// The step of the drive's first sample.
    pub origin: u32,
    /// Control period in s.
    pub period_s: f64,
    /// Steps that the bench missed.
    pub missed: usize,
    /// How often the drive was lost and started again; `None` for an interrupted run, which has counted nothing.
    pub resumes: Option<u64>,
    /// The step from which on the record can't be replayed: the first without an answer in a run whose drive was started
    /// again. In which step it was is not recorded.
    pub ends_before: Option<u32>,
}

/// A step that sent a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RecordedStep {
    /// Step of the run.
    pub step: u32,
    /// The sample. Its sequence number is that of its step since the start of the drive, and not kept here.
    pub sample: EncoderSample,
    /// The torque that answered it; `None` if none came in time. Whether the drive has received such a sample is not known.
    pub torque_nm: Option<f32>,
}

impl Recording {
    /// The recording of a record.
    ///
    /// # Errors
    /// The record lacks the samples, or begins in the middle of a run.
    pub fn new(files: &RecordFiles) -> Result<Self, ReplayError> {
        let missing = |what, remedy| ReplayError::Missing { record: files.name.clone(), what, remedy };
        let Record { manifest, trace: columns, timing, summary, .. } = &files.record;
        if !manifest.mode.is_hil() {
            return Err(missing("samples", "its drive read its own encoders in bench mode"));
        }
        let sent = [MOTOR_COUNTS, LOAD_COUNTS, REFERENCE].map(|name| columns.get(name));
        let ([Some(motor), Some(load), Some(reference)], Some(times_s), Some(torques_nm)) =
            (sent, columns.get("time_s"), columns.get("torque_nm"))
        else {
            let remedy = "run.mcap of a run by this version has them: repeat the run with `lashloop rerun`";
            return Err(missing("samples as they were sent", remedy));
        };
        let answered = timing.get("answered").unwrap_or_default();
        let period_s = match times_s {
            [first_s, second_s, ..] => second_s - first_s,
            _ => return Err(missing("two steps", "a replay needs the start of a run")),
        };
        let rows = times_s.len().min(answered.len());
        let resumes = summary.as_ref().map(|it| it.link.resumes);
        let steps = Vec::with_capacity(rows);
        let mut recording = Self { steps, origin: 0, period_s, missed: 0, resumes, ends_before: None };
        let was_resumed = resumes.is_some_and(|resumes| resumes > 0);
        for row in 0..rows {
            let number = (times_s[row] / period_s).round();
            if row == 0 && number != 0.0 {
                return Err(ReplayError::Start { record: files.name.clone(), step: number as i64 });
            }
            let step = number as u32;
            let is_answered = answered[row] == 1.0;
            if was_resumed && !is_answered {
                recording.ends_before = Some(step);
                break;
            }
            if motor[row].is_nan() {
                recording.missed += 1;
                continue;
            }
            let counts = |counts: f64| EncoderCounts::wrapping(counts as i64);
            let sample = EncoderSample {
                sequence: 0,
                motor_counts: counts(motor[row]),
                load_counts: counts(load[row]),
                reference_rad: reference[row] as f32,
            };
            let torque_nm = is_answered.then_some(torques_nm[row] as f32);
            recording.steps.push(RecordedStep { step, sample, torque_nm });
        }
        // Until the first answer, every step sent the first sample again.
        let first = recording.steps.iter().position(|it| it.torque_nm.is_some());
        let first = first.ok_or_else(|| missing("answered sample", "there is no torque to compare"))?;
        recording.origin = recording.steps[0].step;
        recording.steps.drain(..first);
        Ok(recording)
    }
}
