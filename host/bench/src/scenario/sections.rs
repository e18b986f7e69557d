//! The short sections: run, encoders, link, allowances, telemetry and record.

use std::time::Duration;

use lashloop_plant::ParameterError;
use lashloop_plant::encoder::{
    Encoder, MAX_COUNTS_PER_REV, MAX_ECCENTRICITY_RAD, MAX_NOISE_COUNTS, MIN_COUNTS_PER_REV,
};
use serde::{Deserialize, Serialize};

use super::declare::{Field, choice, integer, number, placed_texts};
use super::origin::Origin;
use super::range::positive;
use super::reader::Section;
use super::tree::Node;
use crate::settings;

/// Largest TOML integer.
const LARGEST: u64 = i64::MAX as u64;

settings! {
    /// Where the samples of a run come from, and where its torques go.
    #[derive(Default, Deserialize)]
    #[serde(rename_all = "lowercase")]
    pub enum RunMode {
        /// the bench simulates the plant and exchanges samples for torques
        default "hil" => Hil,
        /// the drive reads its own encoders and commands its power stage
        "bench" => Bench,
    }
}

impl RunMode {
    /// Whether the run is in HIL mode.
    #[must_use]
    pub fn is_hil(&self) -> bool {
        *self == Self::Hil
    }
}

settings! {
    /// `[run]`.
    #[derive(Debug, Clone, PartialEq, Serialize)]
    pub struct RunSettings {
        /// What closes the loop: the bench with a simulated plant, or the drive with its own pins.
        pub mode: RunMode = choice().or(RunMode::Hil),
        /// Time of the run; simulated in HIL mode.
        pub duration_s: f64 = number(positive(1e5)),
        /// Control period.
        pub control_period_us: u32 = integer(100..=100_000).or(1000),
        /// Seed of every random stream of the run.
        pub seed: u64 = integer(0..=LARGEST).or(1),
        /// Steps at the start that timing statistics omit.
        pub warm_up_steps: u32 = integer(0..=u32::MAX).or(0),
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

    pub(super) fn checked(self, run: &mut Section<'_>) -> Self {
        let (duration_s, period_s) = (self.duration_s, self.control_period_s());
        // A run without a step to judge would meet every limit.
        if self.warm_up_steps > 0 && duration_s >= period_s && self.warm_up_steps >= self.steps() {
            let reason = format!("leaves no step to judge; the run has {} steps", self.steps());
            run.reject("warm_up_steps", reason);
        }
        if duration_s < period_s && run.is_option("control_period_us") {
            let longest = duration_s * 1e6;
            run.reject("control_period_us", format!("is longer than the run; it must be <= {longest} us"));
        } else if duration_s < period_s {
            run.reject(
                "duration_s",
                format!("is shorter than one control period; it must be >= {period_s} s"),
            );
        }
        self
    }
}

settings! {
    /// `[line]`: a line between the law and the motor, in the plant's time.
    #[derive(Debug, Clone, PartialEq, Serialize)]
    pub struct LineSettings {
        /// Constant delay of every torque, from its sample to the motor, in addition to the plant's own.
        pub delay_us: u32 = integer(0..=LONGEST_DELAY_US).or(0),
        /// Upper end of a uniform random part of the delay. Torques keep their order.
        pub jitter_us: u32 = integer(0..=LONGEST_DELAY_US).or(0),
        /// Fraction of torques that never arrive. The motor holds the last one.
        pub loss: f64 = number(0.0..=1.0).or(0.0),
    }
}

/// As a plant's own delay.
const LONGEST_DELAY_US: u32 = 1_000_000;

settings! {
    /// `[encoders]`.
    #[derive(Debug, Clone, PartialEq, Serialize)]
    pub struct EncoderSettings {
        /// Counts per revolution of the motor, after quadrature.
        pub motor_counts_per_rev: u32 = integer(MIN_COUNTS_PER_REV..=MAX_COUNTS_PER_REV).or(131_072),
        /// Counts per revolution of the load, after quadrature.
        pub load_counts_per_rev: u32 = integer(MIN_COUNTS_PER_REV..=MAX_COUNTS_PER_REV).or(131_072),
        /// Amplitude of the noise of both encoders, added before counting, uniform within +- this.
        pub noise_counts: f64 = number(0.0..=MAX_NOISE_COUNTS).or(0.0),
        /// The same of the motor's encoder alone; absent for `noise_counts`.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub motor_noise_counts: Option<f64> = number(0.0..=MAX_NOISE_COUNTS).optional(),
        /// The same of the load's encoder alone; absent for `noise_counts`.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub load_noise_counts: Option<f64> = number(0.0..=MAX_NOISE_COUNTS).optional(),
        /// Once-per-turn error e of the motor's encoder, which shows theta + e sin(theta).
        pub motor_eccentricity_rad: f64 = number(0.0..=MAX_ECCENTRICITY_RAD).or(0.0),
        /// The same of the load's encoder.
        pub load_eccentricity_rad: f64 = number(0.0..=MAX_ECCENTRICITY_RAD).or(0.0),
    }
}

impl EncoderSettings {
    /// The motor's encoder at the start of its noise.
    ///
    /// # Errors
    /// A value is outside its range.
    pub fn motor(&self, seed: u64) -> Result<Encoder, ParameterError> {
        let noise_counts = self.motor_noise_counts.unwrap_or(self.noise_counts);
        Encoder::new(self.motor_counts_per_rev, noise_counts, seed)?
            .with_eccentricity(self.motor_eccentricity_rad)
    }

    /// The load's encoder at the start of its noise.
    ///
    /// # Errors
    /// A value is outside its range.
    pub fn load(&self, seed: u64) -> Result<Encoder, ParameterError> {
        let noise_counts = self.load_noise_counts.unwrap_or(self.noise_counts);
        Encoder::new(self.load_counts_per_rev, noise_counts, seed)?
            .with_eccentricity(self.load_eccentricity_rad)
    }

    /// Keys that displace the shown angle, with their values.
    pub(super) fn errors(&self) -> [(&'static str, f64); 5] {
        [
            ("encoders.noise_counts", self.noise_counts),
            ("encoders.motor_noise_counts", self.motor_noise_counts.unwrap_or_default()),
            ("encoders.load_noise_counts", self.load_noise_counts.unwrap_or_default()),
            ("encoders.motor_eccentricity_rad", self.motor_eccentricity_rad),
            ("encoders.load_eccentricity_rad", self.load_eccentricity_rad),
        ]
    }
}

settings! {
    /// `[link]`.
    #[derive(Debug, Clone, PartialEq, Serialize)]
    pub struct LinkSettings {
        /// Time the bench waits for one answer. Serial ports have timeouts in tenths of a second.
        pub answer_timeout_ms: u32 = integer(100..=30_000).or(1000),
        /// Mean time for which a lockstep run waits for an answer, after 10 s for all. A slower drive ends the run with exit
        /// code 4.
        pub mean_wait_ms: u32 = integer(1..=30_000).or(100),
        /// Silence after which the drive counts as lost. In lockstep it becomes the drive's watchdog, for a drive that the bench
        /// has started at least 30 s.
        pub silence_limit_ms: u32 = integer(100..=60_000).or(2500),
        /// Speed of a serial port. Other links ignore it.
        pub baud: u32 = integer(1200..=12_000_000).or(921_600),
        /// Speed of the modelled UART, from 9600; 0 for none.
        pub modelled_baud: u32 = integer(0..=12_000_000).or(0),
        /// Reaction to the loss or restart of the drive.
        pub on_loss: OnLoss = choice().or(OnLoss::End),
        /// Time for which the bench tries to resume.
        pub resume_limit_ms: u32 = integer(100..=600_000).or(5000),
    }
}

settings! {
    /// Reaction to the loss of the drive.
    pub enum OnLoss {
        /// The run ends.
        "end" => End,
        /// The bench repeats handshake, set-up, arming and start, and the run resumes. Until then the torque is zero.
        "resume" => Resume,
    }
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

    pub(super) fn checked(self, link: &mut Section<'_>) -> Self {
        if (1..SLOWEST_MODELLED_BAUD).contains(&self.modelled_baud) {
            let reason = format!("is too slow; it must be >= {SLOWEST_MODELLED_BAUD} Bd, or 0 for no wire");
            link.reject("modelled_baud", reason);
        }
        self
    }
}

settings! {
    /// `[allow]`: limits beyond which a run is INVALID, because it doesn't judge the drive. 0 by default.
    #[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
    pub struct Allowance {
        /// Steps without an answer.
        pub lost: u64 = integer(0..=LARGEST).or(0),
        /// Steps whose answer arrived late; in real time, all steps without an answer by their end.
        pub late: u64 = integer(0..=LARGEST).or(0),
        /// Frames rejected for their checksum.
        pub crc_errors: u64 = integer(0..=LARGEST).or(0),
        /// Times that a lost drive came back and the run resumed.
        pub resumes: u64 = integer(0..=LARGEST).or(0),
        /// Late steps in a row, in real time; absent for no limit.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub late_in_a_row: Option<u64> = integer(0..=LARGEST).optional(),
        /// 99th percentile of the lateness of the bench's wake-ups in real time; absent for no limit.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub lateness_p99_us: Option<u64> = integer(1..=LARGEST).optional(),
        /// 99th percentile of the round trip; absent for no limit.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub round_trip_p99_us: Option<u64> = integer(1..=LARGEST).optional(),
    }
}

settings! {
    /// `[telemetry]`.
    #[derive(Debug, Clone, PartialEq, Eq, Serialize)]
    pub struct TelemetrySettings {
        /// Period of the drive's telemetry in steps; 0 for none.
        pub every_steps: u16 = integer(0..=u16::MAX).or(10),
        /// Names of the drive's signals to record, 13 at most; absent for all that the law has, as many as fit.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub signals: Option<Vec<SignalChoice>> = signals(),
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

pub(super) fn signals() -> impl Field<Value = Option<Vec<SignalChoice>>> {
    let texts = placed_texts("a list of the drive's signals, such as [\"load_error_rad\"]").optional();
    let choice =
        |node: Node| SignalChoice { name: node.text().unwrap_or_default().to_owned(), origin: node.origin };
    texts.map(move |nodes, _| Some(nodes?.into_iter().map(choice).collect()))
}

settings! {
    /// `[record]`.
    #[derive(Debug, Clone, PartialEq, Eq, Serialize)]
    pub struct RecordSettings {
        /// Rows per chunk written to the record.
        pub flush_rows: u32 = integer(1..=1_000_000).or(1000),
    }
}
