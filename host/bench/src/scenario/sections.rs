//! The short sections: how long and how fast the bench runs, what it senses, how it talks to the drive, what
//! it forgives and what it keeps.

use std::time::Duration;

use lashloop_plant::encoder::{MAX_COUNTS_PER_REV, MAX_NOISE_COUNTS, MIN_COUNTS_PER_REV};
use serde::Serialize;

use super::range::{positive, within};
use super::reader::Section;
use super::unit;

/// Largest TOML integer.
const LARGEST: u64 = i64::MAX as u64;

/// `[run]`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RunSettings {
    /// How long the plant is simulated.
    pub duration_s: f64,
    /// Time between two torques of the drive.
    pub control_period_us: u32,
    /// Starts every random stream of the run.
    pub seed: u64,
    /// Steps at the start whose timing is not looked at.
    pub warm_up_steps: u32,
}

impl RunSettings {
    /// The control period in seconds.
    #[must_use]
    pub fn control_period_s(&self) -> f64 {
        f64::from(self.control_period_us) / 1e6
    }

    /// Control steps of the run: the duration in whole periods, to the nearest. At least 1.
    #[must_use]
    pub fn steps(&self) -> u32 {
        self.step_at(self.duration_s)
    }

    /// The step that begins nearest to a time.
    #[must_use]
    pub fn step_at(&self, time_s: f64) -> u32 {
        // At most 1e5 s / 100 us = 1e9, so the conversion is exact, and a step number holds it.
        (time_s * 1e6 / f64::from(self.control_period_us)).round() as u32
    }
}

pub(super) fn read_run(run: &mut Section<'_>) -> RunSettings {
    let settings = RunSettings {
        duration_s: run.number("duration_s", unit::SECOND, None, positive(1e5)),
        control_period_us: run.integer("control_period_us", unit::MICROSECOND, 1000, 100..=100_000),
        seed: run.integer("seed", unit::NONE, 1, 0..=LARGEST),
        warm_up_steps: run.integer("warm_up_steps", unit::STEP, 0, 0..=u32::MAX),
    };
    let (duration_s, period_s) = (settings.duration_s, settings.control_period_s());
    // Without one step left that counts, everything would be within what is allowed.
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
    /// Counts per turn of the motor.
    pub motor_counts_per_rev: u32,
    /// Counts per turn of the load.
    pub load_counts_per_rev: u32,
    /// Amplitude of the noise added before counting, 0 to 1000 counts; uniform within +- this.
    pub noise_counts: f64,
}

pub(super) fn read_encoders(encoders: &mut Section<'_>) -> EncoderSettings {
    let (per_rev, resolution) = (unit::COUNT_PER_REVOLUTION, MIN_COUNTS_PER_REV..=MAX_COUNTS_PER_REV);
    EncoderSettings {
        motor_counts_per_rev: encoders.integer("motor_counts_per_rev", per_rev, 131_072, resolution.clone()),
        load_counts_per_rev: encoders.integer("load_counts_per_rev", per_rev, 131_072, resolution),
        noise_counts: encoders.number("noise_counts", unit::COUNT, 0.0, within(0.0, MAX_NOISE_COUNTS)),
    }
}

/// `[link]`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LinkSettings {
    /// How long the bench waits for one answer.
    pub answer_timeout_ms: u32,
    /// How long the drive may be silent before the link counts as dead.
    pub silence_limit_ms: u32,
    /// Speed of a tty; other links have none.
    pub baud: u32,
    /// Speed of the wire that is modelled where there is none; 0 for none. See [`crate::link::uart_model`].
    pub modelled_baud: u32,
    /// What becomes of the run when the drive is lost: gone, or started anew.
    pub on_loss: OnLoss,
    /// How long the bench tries to get it back.
    pub resume_limit_ms: u32,
}

/// What becomes of a run when the drive is lost.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum OnLoss {
    /// It ends.
    End,
    /// The drive is greeted, set up, armed and started again, and the run goes on. Until then there is no torque.
    Resume,
}

/// The slowest wire that is modelled. On a slower one the greeting of a drive takes longer than the bench waits for it.
const SLOWEST_MODELLED_BAUD: u32 = 9_600;

impl LinkSettings {
    /// How long the bench waits for one answer.
    #[must_use]
    pub fn answer_timeout(&self) -> Duration {
        Duration::from_millis(self.answer_timeout_ms.into())
    }

    /// How long the bench tries to get a lost drive back.
    #[must_use]
    pub fn resume_limit(&self) -> Duration {
        Duration::from_millis(self.resume_limit_ms.into())
    }

    /// How long the drive may be silent.
    #[must_use]
    pub fn silence_limit(&self) -> Duration {
        Duration::from_millis(self.silence_limit_ms.into())
    }

    /// Speed of the modelled wire, if there is to be one.
    #[must_use]
    pub fn modelled_baud(&self) -> Option<u32> {
        (self.modelled_baud > 0).then_some(self.modelled_baud)
    }
}

pub(super) fn read_link(link: &mut Section<'_>) -> LinkSettings {
    let settings = LinkSettings {
        // A terminal waits in tenths of a second. The drive's watchdog gets the silence limit, and bears a minute.
        answer_timeout_ms: link.integer("answer_timeout_ms", unit::MILLISECOND, 1000, 100..=30_000),
        silence_limit_ms: link.integer("silence_limit_ms", unit::MILLISECOND, 2500, 100..=60_000),
        baud: link.integer("baud", unit::BAUD, 921_600, 1200..=12_000_000),
        modelled_baud: link.integer("modelled_baud", unit::BAUD, 0, 0..=12_000_000),
        on_loss: link
            .choice("on_loss", OnLoss::End, &[("end", OnLoss::End), ("resume", OnLoss::Resume)])
            .unwrap_or(OnLoss::End),
        resume_limit_ms: link.integer("resume_limit_ms", unit::MILLISECOND, 5000, 100..=600_000),
    };
    if (1..SLOWEST_MODELLED_BAUD).contains(&settings.modelled_baud) {
        link.reject(
            "modelled_baud",
            format!("is too slow; it must be >= {SLOWEST_MODELLED_BAUD} Bd, or 0 for no wire"),
        );
    }
    settings
}

/// `[allow]`: what the link may lose before the run says nothing any more and its verdict is INVALID.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct Allowance {
    /// Steps without an answer.
    pub lost: u64,
    /// Steps whose answer came too late; in real time every step without an answer by its end.
    pub late: u64,
    /// Frames refused for their checksum.
    pub crc_errors: u64,
    /// Times that a lost drive came back and the run went on.
    pub resumes: u64,
    /// Late steps in a row, in real time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub late_in_a_row: Option<u64>,
    /// Lateness of the bench's wake-ups in real time, 99th percentile.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lateness_p99_us: Option<u64>,
    /// Round trips, 99th percentile.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub round_trip_p99_us: Option<u64>,
}

pub(super) fn read_allow(allow: &mut Section<'_>) -> Allowance {
    Allowance {
        lost: allow.integer("lost", unit::STEP, 0, 0..=LARGEST),
        late: allow.integer("late", unit::STEP, 0, 0..=LARGEST),
        crc_errors: allow.integer("crc_errors", unit::NONE, 0, 0..=LARGEST),
        resumes: allow.integer("resumes", unit::NONE, 0, 0..=LARGEST),
        late_in_a_row: allow.optional_integer("late_in_a_row", unit::STEP, 0..=LARGEST),
        lateness_p99_us: allow.optional_integer("lateness_p99_us", unit::MICROSECOND, 1..=LARGEST),
        round_trip_p99_us: allow.optional_integer("round_trip_p99_us", unit::MICROSECOND, 1..=LARGEST),
    }
}

/// `[telemetry]`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct TelemetrySettings {
    /// The drive reports its inner state every so many steps; 0 for never.
    pub every_steps: u16,
}

pub(super) fn read_telemetry(telemetry: &mut Section<'_>) -> TelemetrySettings {
    TelemetrySettings { every_steps: telemetry.integer("every_steps", unit::STEP, 10, 0..=u16::MAX) }
}

/// `[record]`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct RecordSettings {
    /// Rows of the trace that reach the file together.
    pub flush_rows: u32,
}

pub(super) fn read_record(record: &mut Section<'_>) -> RecordSettings {
    RecordSettings { flush_rows: record.integer("flush_rows", unit::ROW, 1000, 1..=1_000_000) }
}
