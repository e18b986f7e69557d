//! A step of a run, without an allocation: it goes from the thread of the loop to the record.

use heapless::Vec;
use lashloop_plant::limits::MAX_SIGNALS;
use lashloop_plant::metrics::Sample;
use lashloop_protocol::limits::MAX_TELEMETRY_VALUES;
use lashloop_protocol::message::{EncoderSample, Telemetry};

use super::error::RunError;
use crate::device::Device;
use crate::scenario::RunMode;
use crate::timing::StepTiming;
use lashloop_session::AtStep;

/// What every run has for a step. Positions are the true ones at `time_s`, in bench mode those of the drive's encoders.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TraceRow {
    /// Time of the run.
    pub time_s: f64,
    /// Commanded load position.
    pub reference_rad: f64,
    /// Load position theta_s.
    pub load_position_rad: f64,
    /// Motor position theta_e.
    pub motor_position_rad: f64,
    /// Torque U, held from `time_s` on.
    pub torque_nm: f64,
}

/// A finished step.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// Time, reference, positions and torque.
    pub row: TraceRow,
    /// The sample that was sent, with the faults of the encoders; in bench mode the counts that the drive has reported, with
    /// the reference that it steps by. `None` in a step without a sample or without a report.
    pub sample: Option<EncoderSample>,
    /// The plant's truth at that time, in the order of its signals.
    pub plant: TruthValues,
    /// The drive's signals, in the order of the subscription.
    pub drive: DriveValues,
    /// How the step went in time.
    pub timing: StepTiming,
}

/// What is known of a step before its exchange.
#[derive(Debug, Clone, PartialEq)]
pub struct Observation {
    /// The torque is that of the exchange, so it is 0 here.
    pub row: TraceRow,
    /// The plant's truth.
    pub plant: TruthValues,
}

/// Values of the plant's signals.
pub type TruthValues = Vec<f64, MAX_SIGNALS>;

/// Values of the subscribed signals, from the latest telemetry.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct DriveValues {
    /// NaN before the first telemetry.
    pub values: Vec<f64, MAX_TELEMETRY_VALUES>,
    /// Time of the sample that they belong to; `None` before the first telemetry.
    pub time_s: Option<f64>,
}

impl DriveValues {
    /// Before the first telemetry of `count` signals, [`MAX_TELEMETRY_VALUES`] at most.
    pub(super) fn unknown(count: usize) -> Self {
        Self { values: std::iter::repeat_n(f64::NAN, count).collect(), time_s: None }
    }

    /// Takes the values of a telemetry. `origin` is the step of the drive's first sample.
    pub(super) fn take(
        &mut self,
        telemetry: &AtStep<Telemetry>,
        origin: u32,
        period_s: f64,
        device: &Device,
    ) -> Result<(), RunError> {
        let sent = telemetry.values.as_slice();
        if sent.len() != self.values.len() {
            let (have, want) = (sent.len(), self.values.len());
            return Err(device
                .unfit(format!("its telemetry has {have} signals; {want} are subscribed"))
                .into());
        }
        for (value, sent) in self.values.iter_mut().zip(sent) {
            *value = f64::from(*sent);
        }
        // Not as integers: a drive may send any sequence number.
        let sent_at = f64::from(origin) + f64::from(telemetry.step);
        self.time_s = Some(sent_at * period_s);
        Ok(())
    }
}

impl Step {
    /// What the metrics of a run in this mode take of the step. In bench mode the plant's signals aren't the truth.
    #[must_use]
    pub fn measured(&self, mode: RunMode) -> Sample<'_> {
        let row = &self.row;
        Sample {
            time_s: row.time_s,
            reference_rad: row.reference_rad,
            load_position_rad: row.load_position_rad,
            motor_position_rad: row.motor_position_rad,
            torque_nm: row.torque_nm,
            plant: match mode {
                RunMode::Hil => &self.plant,
                RunMode::Bench => &[],
            },
            drive: self.fresh_drive(),
        }
    }

    /// The drive's signals at this very step; `None` without a telemetry of its own. Values that are repeated until the next
    /// telemetry or came too late must not be compared with the truth of another step.
    #[must_use]
    pub fn fresh_drive(&self) -> Option<&[f64]> {
        (self.drive.time_s == Some(self.row.time_s)).then_some(&self.drive.values)
    }
}
