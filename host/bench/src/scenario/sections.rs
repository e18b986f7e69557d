//! The short sections: run, encoders, link, allowances, telemetry and record.

use std::time::Duration;

use lashloop_plant::encoder::{MAX_COUNTS_PER_REV, MAX_NOISE_COUNTS, MIN_COUNTS_PER_REV};
use serde::Serialize;

use super::keys::{integer_or, number, number_or, optional_integer, settings};
use super::origin::Origin;
use super::range::positive;
use super::reader::Section;
use super::run_mode::{self, RunMode};

/// Largest TOML integer.
const LARGEST: u64 = i64::MAX as u64;

settings! {
    /// `[run]`.
    pub struct RunSettings {
        /// What closes the loop: the bench with a simulated plant, or the drive with its own pins.
        mode: RunMode = run_mode::read,
        /// Time of the run; simulated in HIL mode.
        duration_s: f64 = number(positive(1e5)),
        /// Control period.
        control_period_us: u32 = integer_or(1000, 100..=100_000),
        /// Seed of every random stream of the run.
        seed: u64 = integer_or(1, 0..=LARGEST),
        /// Steps at the start that timing statistics omit.
        warm_up_steps: u32 = integer_or(0, 0..=u32::MAX),
    }
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
    let settings = RunSettings::read(run);
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

settings! {
    /// `[line]`: a line between the law and the motor, in the plant's time.
    pub struct LineSettings {
        /// Constant delay of every torque, from its sample to the motor, in addition to the plant's own.
        delay_us: u32 = integer_or(0, 0..=LONGEST_DELAY_US),
        /// Upper end of a uniform random part of the delay. Torques keep their order.
        jitter_us: u32 = integer_or(0, 0..=LONGEST_DELAY_US),
        /// Fraction of torques that never arrive. The motor holds the last one.
        loss: f64 = number_or(0.0, 0.0..=1.0),
    }
}

/// As a plant's own delay.
const LONGEST_DELAY_US: u32 = 1_000_000;

settings! {
    /// `[encoders]`.
    pub struct EncoderSettings {
        /// Counts per revolution of the motor, after quadrature.
        motor_counts_per_rev: u32 = integer_or(131_072, MIN_COUNTS_PER_REV..=MAX_COUNTS_PER_REV),
        /// Counts per revolution of the load, after quadrature.
        load_counts_per_rev: u32 = integer_or(131_072, MIN_COUNTS_PER_REV..=MAX_COUNTS_PER_REV),
        /// Amplitude of the noise added before counting, uniform within +- this.
        noise_counts: f64 = number_or(0.0, 0.0..=MAX_NOISE_COUNTS),
    }
}

settings! {
    /// `[link]`.
    pub struct LinkSettings {
        /// Time the bench waits for one answer. Serial ports have timeouts in tenths of a second.
        answer_timeout_ms: u32 = integer_or(1000, 100..=30_000),
        /// Mean time for which a lockstep run waits for an answer, after 10 s for all. A slower drive ends the run with exit
        /// code 4.
        mean_wait_ms: u32 = integer_or(100, 1..=30_000),
        /// Silence after which the drive counts as lost. In lockstep it becomes the drive's watchdog.
        silence_limit_ms: u32 = integer_or(2500, 100..=60_000),
        /// Speed of a serial port. Other links ignore it.
        baud: u32 = integer_or(921_600, 1200..=12_000_000),
        /// Speed of the modelled UART, from 9600; 0 for none.
        modelled_baud: u32 = integer_or(0, 0..=12_000_000),
        /// Reaction to the loss or restart of the drive.
        on_loss: OnLoss = read_on_loss,
        /// Time for which the bench tries to resume.
        resume_limit_ms: u32 = integer_or(5000, 100..=600_000),
    }
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

    /// Time that a lockstep run waits for an answer on average.
    #[must_use]
    pub fn mean_wait(&self) -> Duration {
        Duration::from_millis(self.mean_wait_ms.into())
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

fn read_on_loss(link: &mut Section<'_>, key: &'static str) -> OnLoss {
    let choices = [("end", OnLoss::End), ("resume", OnLoss::Resume)];
    link.choice(key, OnLoss::End, &choices).unwrap_or(OnLoss::End)
}

pub(super) fn read_link(link: &mut Section<'_>) -> LinkSettings {
    let settings = LinkSettings::read(link);
    if (1..SLOWEST_MODELLED_BAUD).contains(&settings.modelled_baud) {
        link.reject(
            "modelled_baud",
            format!("is too slow; it must be >= {SLOWEST_MODELLED_BAUD} Bd, or 0 for no wire"),
        );
    }
    settings
}

settings! {
    /// `[allow]`: limits beyond which a run is INVALID, because it doesn't judge the drive. 0 by default.
    #[derive(Copy, Default, Eq)]
    pub struct Allowance {
        /// Steps without an answer.
        lost: u64 = integer_or(0, 0..=LARGEST),
        /// Steps whose answer arrived late; in real time, all steps without an answer by their end.
        late: u64 = integer_or(0, 0..=LARGEST),
        /// Frames rejected for their checksum.
        crc_errors: u64 = integer_or(0, 0..=LARGEST),
        /// Times that a lost drive came back and the run resumed.
        resumes: u64 = integer_or(0, 0..=LARGEST),
        /// Late steps in a row, in real time; absent for no limit.
        #[serde(skip_serializing_if = "Option::is_none")]
        late_in_a_row: Option<u64> = optional_integer(0..=LARGEST),
        /// 99th percentile of the lateness of the bench's wake-ups in real time; absent for no limit.
        #[serde(skip_serializing_if = "Option::is_none")]
        lateness_p99_us: Option<u64> = optional_integer(1..=LARGEST),
        /// 99th percentile of the round trip; absent for no limit.
        #[serde(skip_serializing_if = "Option::is_none")]
        round_trip_p99_us: Option<u64> = optional_integer(1..=LARGEST),
    }
}

settings! {
    /// `[telemetry]`.
    #[derive(Eq)]
    pub struct TelemetrySettings {
        /// Period of the drive's telemetry in steps; 0 for none.
        every_steps: u16 = integer_or(10, 0..=u16::MAX),
        /// Names of the drive's signals to record, 13 at most; absent for all that the law has, as many as fit.
        #[serde(skip_serializing_if = "Option::is_none")]
        signals: Option<Vec<SignalChoice>> = read_signals,
    }
}

/// A signal by its name. The drive describes its signals; an unknown one is reported at connection.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(transparent)]
pub struct SignalChoice {
    /// Name of the signal.
    pub name: String,
    /// Where it is named.
    #[serde(skip)]
    pub origin: Origin,
}

fn read_signals(telemetry: &mut Section<'_>, key: &'static str) -> Option<Vec<SignalChoice>> {
    let signals =
        telemetry.optional_texts(key, "a list of the drive's signals, such as [\"load_error_rad\"]")?;
    let choice =
        |(name, origin): (&str, &Origin)| SignalChoice { name: name.to_owned(), origin: origin.clone() };
    Some(signals.into_iter().map(choice).collect())
}

settings! {
    /// `[record]`.
    #[derive(Eq)]
    pub struct RecordSettings {
        /// Rows per chunk written to the record.
        flush_rows: u32 = integer_or(1000, 1..=1_000_000),
    }
}
