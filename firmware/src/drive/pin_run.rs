//! A run of bench mode: the pins instead of the host's samples.

use core::f32::consts::TAU;
use core::time::Duration;

use lashloop_protocol::EncoderCounts;
use lashloop_protocol::enums::FaultCode;
use lashloop_protocol::message::{EncoderSample, Reference};

use super::guard::Guard;
use super::motor_direction::MotorDirection;
use super::pin_parameters::PinParameters;
use super::pins::{PinReadings, Pins};
use super::safety::Violation;
use crate::law::{DriveParameters, ParameterError, Real};
use crate::power_stage::Modulation;

/// Longest time from the start to the first tick: longer than any period that was in force before.
const FIRST_TICK: Duration = Duration::from_millis(150);

/// Configuration and state of a run on the pins.
pub(super) struct PinRun {
    parameters: PinParameters,
    modulation: Modulation,
    period: Duration,
    /// Largest change of the torque in a period, in N m.
    slew_nm: f32,
    motor_rad: f32,
    /// One count of the load encoder in rad at the motor.
    load_rad: f32,
    reduction_ratio: f32,
    started_at: Duration,
    /// The latest readings at the start.
    first: PinReadings,
    last_due: Option<Duration>,
    /// `None` until the host sends one: a law without a reference is not stepped.
    reference: Option<Reference>,
    next_sequence: u16,
    /// Steps before the next report.
    unreported: u16,
    twist: Option<TwistCheck>,
    guard: Guard,
    /// Counts of the hardware at the zero of motor and load.
    zero: [EncoderCounts; 2],
    direction: MotorDirection,
    /// Counts of the load at the first step.
    first_load: Option<EncoderCounts>,
    /// Counts at the last step.
    last: Option<(EncoderCounts, EncoderCounts)>,
}

/// The twist at the first step, and where the encoders were when it was last near to it.
#[derive(Clone, Copy)]
struct TwistCheck {
    first_rad: f32,
    near: (EncoderCounts, EncoderCounts),
}

impl PinRun {
    /// # Errors
    /// The board doesn't have the mode of the power stage.
    pub(super) fn new(
        parameters: PinParameters,
        drive: &DriveParameters,
        pins: &Pins,
        now: Duration,
    ) -> Result<Self, ParameterError> {
        let period = Duration::from_micros(drive.period_us.into());
        let slew_nm_s = parameters.torque_slew_nm_s;
        Ok(Self {
            modulation: parameters.modulation(pins.hardware())?,
            parameters,
            period,
            slew_nm: slew_nm_s * drive.period_s(),
            motor_rad: TAU / drive.motor_counts_per_rev as f32,
            load_rad: TAU / drive.load_counts_per_rev as f32 * drive.reduction_ratio,
            reduction_ratio: drive.reduction_ratio,
            started_at: now,
            first: pins.readings(),
            last_due: None,
            reference: None,
            next_sequence: 0,
            unreported: 0,
            twist: None,
            guard: Guard::new(drive),
            zero: pins.zero(),
            direction: MotorDirection::new(drive.torque_limit_nm, pins.rested(now)),
            first_load: None,
            last: None,
        })
    }

    pub(super) fn parameters(&self) -> &PinParameters {
        &self.parameters
    }

    pub(super) fn modulation(&self) -> &Modulation {
        &self.modulation
    }

    pub(super) fn take_reference(&mut self, reference: Reference) {
        self.reference = Some(reference);
    }

    /// Number of the reference in force.
    pub(super) fn reference_number(&self) -> u16 {
        self.reference.map_or(0, |reference| reference.number)
    }

    /// Control period of the run.
    pub(super) fn period(&self) -> Duration {
        self.period
    }

    /// A tick is missing if the next one is due later than this, or hasn't come until then.
    fn missing_after(&self) -> Duration {
        self.period + self.period / 2
    }

    /// Whether a `BenchSample` follows this step. To be called once per step: a sequence number wraps, and
    /// `bench_sample_every` need not divide its range.
    pub(super) fn is_reported(&mut self) -> bool {
        let is_reported = self.unreported == 0;
        // At most 1,000 steps.
        let before = if is_reported { self.parameters.bench_sample_every as u16 } else { self.unreported };
        self.unreported = before.saturating_sub(1);
        is_reported
    }

    /// The sample of a period, in the directions and with the reference in force; `None` before the first reference.
    ///
    /// # Errors
    /// A fault of the power stage, a missing tick, or an illegal transition.
    pub(super) fn sample(
        &mut self,
        readings: &PinReadings,
        due: Duration,
    ) -> Result<Option<EncoderSample>, Violation> {
        if let Some(fault) = readings.stage_fault.or(self.parameters.missing_enable(readings)) {
            let detail = fault as u32;
            return Err(Violation { detail, ..Violation::of(FaultCode::PowerStage) });
        }
        let since = self.last_due.replace(due).map_or(Duration::ZERO, |last| due.saturating_sub(last));
        in_time(since, self.missing_after())?;
        for (code, now, then) in [
            (FaultCode::MotorEncoderLost, readings.motor, self.first.motor),
            (FaultCode::LoadEncoderLost, readings.load, self.first.load),
        ] {
            let detail = now.illegal_transitions.wrapping_sub(then.illegal_transitions);
            if detail > 0 {
                return Err(Violation { detail, ..Violation::of(code) });
            }
        }
        let Some(Reference { reference_rad, .. }) = self.reference else { return Ok(None) };
        let sequence = self.next_sequence;
        self.next_sequence = sequence.wrapping_add(1);
        let of_drive = &self.parameters;
        Ok(Some(EncoderSample {
            sequence,
            motor_counts: of_drive.motor_direction.of_counts(from_zero(readings.motor.counts, self.zero[0])),
            load_counts: of_drive.load_direction.of_counts(from_zero(readings.load.counts, self.zero[1])),
            reference_rad,
        }))
    }

    /// Checks that the motor turned as the torque of the last period says.
    ///
    /// # Errors
    /// It ran away from its torque.
    pub(super) fn check_direction(
        &mut self,
        sample: &EncoderSample,
        torque_nm: f32,
    ) -> Result<(), Violation> {
        if self.direction.is_judged() {
            return Ok(());
        }
        let (motor, load) = (sample.motor_counts, sample.load_counts);
        let first_load = *self.first_load.get_or_insert(load);
        let Some(last) = self.last.replace((motor, load)) else { return Ok(()) };
        let moved = |now: EncoderCounts, then, rad: f32| now.wrapping_sub(then) as f32 * rad;
        let moved_rad = [moved(motor, last.0, self.motor_rad), moved(load, last.1, self.load_rad)];
        let way_rad = sample.reference_rad * self.reduction_ratio - first_load.get() as f32 * self.load_rad;
        self.direction.check(moved_rad, way_rad, torque_nm)
    }

    /// Checks that the twist is near to that of the first step. Gap and elastic twist are bounded; the twist of an encoder
    /// that stands still while the other one moves is not.
    ///
    /// # Errors
    /// The encoder that has moved less since the twist was near.
    pub(super) fn check_twist(&mut self, sample: &EncoderSample, twist_rad: f32) -> Result<(), Violation> {
        let here = (sample.motor_counts, sample.load_counts);
        let check = self.twist.get_or_insert(TwistCheck { first_rad: twist_rad, near: here });
        let (change, limit) = (Real::abs(twist_rad - check.first_rad), self.parameters.twist_limit_rad);
        if change <= limit / 2.0 {
            check.near = here;
        }
        if change <= limit {
            return Ok(());
        }
        if let Some(violation) = self.direction.explains_twist() {
            return Err(violation);
        }
        let moved = |now: EncoderCounts, then, rad: f32| now.wrapping_sub(then).unsigned_abs() as f32 * rad;
        let motor_moved_less =
            moved(here.0, check.near.0, self.motor_rad) < moved(here.1, check.near.1, self.load_rad);
        let code = if motor_moved_less { FaultCode::MotorEncoderLost } else { FaultCode::LoadEncoderLost };
        Err(Violation { code, value: change, limit, detail: 0 })
    }

    /// A torque that is near enough to the last one, all in N m.
    pub(super) fn slow_down(&self, torque_nm: f32, last_nm: f32) -> f32 {
        Real::clamp(torque_nm, last_nm - self.slew_nm, last_nm + self.slew_nm)
    }

    /// Checks the limits that hold without a host, see [`Guard::check`].
    pub(super) fn check_limits(
        &mut self,
        counts: [i32; 2],
        readings: &PinReadings,
        torques_nm: [f32; 3],
    ) -> Result<(), Violation> {
        self.guard.check(&self.parameters, counts, readings, torques_nm)
    }

    /// Checks that the step due at `due` ended within its period.
    pub(super) fn check_end(&self, due: Duration, now: Duration) -> Result<(), Violation> {
        in_time(now.saturating_sub(due), self.period)
    }

    /// Checks that ticks come at all.
    pub(super) fn check_silence(&self, now: Duration) -> Result<(), Violation> {
        let (since, limit) = match self.last_due {
            None => (self.started_at, FIRST_TICK),
            Some(due) => (due, self.missing_after()),
        };
        in_time(now.saturating_sub(since), limit)
    }

    /// The next tick has not come in time.
    pub(super) fn overdue(&self, now: Duration) -> Violation {
        overrun(now.saturating_sub(self.last_due.unwrap_or(self.started_at)), self.missing_after())
    }
}

/// A reading in coordinates with this zero.
fn from_zero(counts: EncoderCounts, zero: EncoderCounts) -> EncoderCounts {
    EncoderCounts::wrapping(counts.wrapping_sub(zero).into())
}

fn in_time(time: Duration, limit: Duration) -> Result<(), Violation> {
    if time <= limit { Ok(()) } else { Err(overrun(time, limit)) }
}

fn overrun(time: Duration, limit: Duration) -> Violation {
    let (value, limit) = (time.as_secs_f32(), limit.as_secs_f32());
    Violation { code: FaultCode::TickOverrun, value, limit, detail: 0 }
}
