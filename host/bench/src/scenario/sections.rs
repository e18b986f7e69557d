//! The short sections: run, encoders, link, allowances, telemetry and record.

use std::time::Duration;

use lashloop_plant::encoder::{MAX_COUNTS_PER_REV, MAX_NOISE_COUNTS, MIN_COUNTS_PER_REV};
use serde::Serialize;

use super::range::positive;
use super::reader::Section;

/// Largest TOML integer.
const LARGEST: u64 = i64::MAX as u64;

/// `[run]`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RunSettings {
    /// Simulated time, > 0 and <= 1e5 s.
    pub duration_s: f64,
    /// Control period, 100 to 100,000 us; 1000 by default.
    pub control_period_us: u32,
    /// Seed of every random stream of the run; 1 by default.
    pub seed: u64,
    /// Steps at the start that timing statistics omit; 0 by default.
    pub warm_up_steps: u32,
}

impl RunSettings {
    /// Control period in s.
    #[must_use]
    pub fn control_period_s(&self) -> f64 {
        f64::from(self.control_period_us) / 1e6
    }

    /// Control steps of the run: its duration in periods, rounded to the nearest, at least 1.
    #[must_use]
    pub fn steps(&self) -> u32 {
        self.step_at(self.duration_s)
    }

    /// The step that begins nearest to a time of the run.
    #[must_use]
    pub fn step_at(&self, time_s: f64) -> u32 {
        // At most 1e5 s / 100 us = 1e9, so the conversion is exact, and a step number holds it.
        (time_s * 1e6 / f64::from(self.control_period_us)).round() as u32
    }
}

pub(super) fn read_run(run: &mut Section<'_>) -> RunSettings {
    let settings = RunSettings {
        duration_s: run.number("duration_s", None, positive(1e5)),
        control_period_us: run.integer("control_period_us", 1000, 100..=100_000),
        seed: run.integer("seed", 1, 0..=LARGEST),
        warm_up_steps: run.integer("warm_up_steps", 0, 0..=u32::MAX),
    };
    let (duration_s, period_s) = (settings.duration_s, settings.control_period_s());
    // A run without a step to judge would meet every limit.
    if settings.warm_up_steps > 0 && duration_s >= period_s && settings.warm_up_steps >= settings.steps() {
        let reason = format!("leaves no step to judge; the run has {} steps", settings.steps());
        run.reject("warm_up_steps", reason);
    }
    if duration_s < period_s && run.is_option("control_period_us") {
        run.reject(
            "control_period_us",
            format!("is longer than the run; it must be <= {} us", duration_s * 1e6),
        );
    } else if duration_s < period_s {
        run.reject("duration_s", format!("is shorter than one control period; it must be >= {period_s} s"));
    }
    settings
}

/// `[encoders]`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EncoderSettings {
    /// Counts per revolution of the motor, after quadrature; 131,072 by default.
    pub motor_counts_per_rev: u32,
    /// Counts per revolution of the load, after quadrature; 131,072 by default.
    pub load_counts_per_rev: u32,
    /// Amplitude of the noise added before counting, 0 to 1000 counts; uniform within +- this.
    pub noise_counts: f64,
}

pub(super) fn read_encoders(encoders: &mut Section<'_>) -> EncoderSettings {
    let resolution = MIN_COUNTS_PER_REV..=MAX_COUNTS_PER_REV;
    EncoderSettings {
        motor_counts_per_rev: encoders.integer("motor_counts_per_rev", 131_072, resolution.clone()),
        load_counts_per_rev: encoders.integer("load_counts_per_rev", 131_072, resolution),
        noise_counts: encoders.number("noise_counts", 0.0, 0.0..=MAX_NOISE_COUNTS),
    }
}

/// `[link]`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LinkSettings {
    /// Time the bench waits for one answer, 100 to 30,000 ms; 1000 by default.
    pub answer_timeout_ms: u32,
    /// Silence after which the drive counts as lost, 100 to 60,000 ms; 2500 by default.
    pub silence_limit_ms: u32,
    /// Speed of a serial port, 1200 to 12,000,000 Bd; 921,600 by default. Other links ignore it.
    pub baud: u32,
    /// Speed of the modelled UART, 9600 to 12,000,000 Bd; 0, the default, for none. See [`crate::link::uart_model`].
    pub modelled_baud: u32,
    /// Reaction to the loss or restart of the drive; `end` by default.
    pub on_loss: OnLoss,
    /// Time for which the bench tries to resume, 100 to 600,000 ms; 5000 by default.
    pub resume_limit_ms: u32,
}

/// Reaction to the loss of the drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum OnLoss {
    /// The run ends.
    End,
    /// The bench repeats handshake, set-up, arming and start, and the run resumes. Until then the torque is zero.
    Resume,
}

/// Slowest modelled UART. On a slower one the handshake takes longer than its timeout.
const SLOWEST_MODELLED_BAUD: u32 = 9_600;

impl LinkSettings {
    /// Time the bench waits for one answer.
    #[must_use]
    pub fn answer_timeout(&self) -> Duration {
        Duration::from_millis(self.answer_timeout_ms.into())
    }

    /// Time for which the bench tries to resume.
    #[must_use]
    pub fn resume_limit(&self) -> Duration {
        Duration::from_millis(self.resume_limit_ms.into())
    }

    /// Silence after which the drive counts as lost.
    #[must_use]
    pub fn silence_limit(&self) -> Duration {
        Duration::from_millis(self.silence_limit_ms.into())
    }

    /// Speed of the modelled UART in Bd, if the scenario has one.
    #[must_use]
    pub fn modelled_baud(&self) -> Option<u32> {
        (self.modelled_baud > 0).then_some(self.modelled_baud)
    }
}

pub(super) fn read_link(link: &mut Section<'_>) -> LinkSettings {
    let settings = LinkSettings {
        // Serial ports have timeouts in tenths of a second. The silence limit becomes the drive's watchdog, whose limit is 60 s.
        answer_timeout_ms: link.integer("answer_timeout_ms", 1000, 100..=30_000),
        silence_limit_ms: link.integer("silence_limit_ms", 2500, 100..=60_000),
        baud: link.integer("baud", 921_600, 1200..=12_000_000),
        modelled_baud: link.integer("modelled_baud", 0, 0..=12_000_000),
        on_loss: link
            .choice("on_loss", OnLoss::End, &[("end", OnLoss::End), ("resume", OnLoss::Resume)])
            .unwrap_or(OnLoss::End),
        resume_limit_ms: link.integer("resume_limit_ms", 5000, 100..=600_000),
    };
    if (1..SLOWEST_MODELLED_BAUD).contains(&settings.modelled_baud) {
        link.reject(
            "modelled_baud",
            format!("is too slow; it must be >= {SLOWEST_MODELLED_BAUD} Bd, or 0 for no wire"),
        );
    }
    settings
}

/// `[allow]`: limits beyond which a run is INVALID, because it doesn't judge the drive. 0 by default.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct Allowance {
    /// Steps without an answer.
    pub lost: u64,
    /// Steps whose answer arrived late; in real time, all steps without an answer by their end.
    pub late: u64,
    /// Frames rejected for their checksum.
    pub crc_errors: u64,
    /// Times that a lost drive came back and the run resumed.
    pub resumes: u64,
    /// Late steps in a row, in real time; unlimited by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub late_in_a_row: Option<u64>,
    /// 99th percentile of the lateness of the bench's wake-ups in real time; unlimited by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lateness_p99_us: Option<u64>,
    /// 99th percentile of the round trip; unlimited by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub round_trip_p99_us: Option<u64>,
}

pub(super) fn read_allow(allow: &mut Section<'_>) -> Allowance {
    Allowance {
        lost: allow.integer("lost", 0, 0..=LARGEST),
        late: allow.integer("late", 0, 0..=LARGEST),
        crc_errors: allow.integer("crc_errors", 0, 0..=LARGEST),
        resumes: allow.integer("resumes", 0, 0..=LARGEST),
        late_in_a_row: allow.optional_integer("late_in_a_row", 0..=LARGEST),
        lateness_p99_us: allow.optional_integer("lateness_p99_us", 1..=LARGEST),
        round_trip_p99_us: allow.optional_integer("round_trip_p99_us", 1..=LARGEST),
    }
}

/// `[telemetry]`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct TelemetrySettings {
    /// Period of the drive's telemetry in steps; 10 by default, 0 for none.
    pub every_steps: u16,
}

pub(super) fn read_telemetry(telemetry: &mut Section<'_>) -> TelemetrySettings {
    TelemetrySettings { every_steps: telemetry.integer("every_steps", 10, 0..=u16::MAX) }
}

/// `[record]`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct RecordSettings {
    /// Rows per chunk written to the record, 1 to 1,000,000; 1000 by default.
    pub flush_rows: u32,
}

pub(super) fn read_record(record: &mut Section<'_>) -> RecordSettings {
    RecordSettings { flush_rows: record.integer("flush_rows", 1000, 1..=1_000_000) }
}
