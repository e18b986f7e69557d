//! What a drive reads from its own pins, and whether that is plausible enough to arm.

use core::f32::consts::TAU;
use core::time::Duration;

use lashloop_protocol::EncoderCounts;
use lashloop_protocol::enums::Outcome;

use super::refusal::Refusal;
use crate::contact::Contacts;
use crate::input_filter::{InputFilter, filter_for};
use crate::law::{DriveParameters, ParameterError, ROUNDING};
use crate::power_stage::{PowerStageFault, StageMode};
use crate::torque::TorqueSource;

/// Mechanics that moved less in this time have rested.
const REST: Duration = Duration::from_millis(500);
/// Motion of an encoder at rest, in counts.
const REST_COUNTS: u32 = 4;

/// Limits of the hardware of bench mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PinHardware {
    /// Largest motion of an encoder in one period that its counter shows without ambiguity, in counts.
    pub largest_move_counts: u16,
    /// Filters that the inputs of an encoder can have, ascending.
    pub filters: &'static [InputFilter],
    /// Modes that the outputs to the power stage can have, that of the parameters' defaults first.
    pub stage_modes: &'static [StageMode],
    /// Longest period of the tick, in us.
    pub longest_period_us: u32,
    /// Whether it measures the current of a bridge, and the voltage of its bus.
    pub measures_current: bool,
    /// Whether the counters of motor and load keep their count at an index pulse.
    pub has_index: [bool; 2],
}

/// Limits of the hardware with the filter in force.
#[derive(Clone, Copy, Debug)]
pub(super) struct PinLimits {
    pub(super) largest_move_counts: f32,
    /// Fastest motion of an encoder whose edges pass the filter, in counts per second: a level of a channel lasts two counts, and
    /// down to 1.5 where the channels of an encoder are uneven.
    pub(super) largest_counts_per_s: f32,
    pub(super) longest_period_us: f32,
}

impl PinHardware {
    /// What makes the torque.
    ///
    /// # Errors
    /// Nothing measures the current that is to make it.
    pub(super) fn source(&self, source: TorqueSource) -> Result<TorqueSource, ParameterError> {
        if source == TorqueSource::Current && !self.measures_current {
            let (value, max) = (source as u32 as f32, TorqueSource::Voltage as u32 as f32);
            let given_by = "the current sensor that the board lacks";
            return Err(ParameterError { name: "torque_source", value, max, given_by });
        }
        Ok(source)
    }

    /// The limits with the shortest filter that stops pulses of this length.
    ///
    /// # Errors
    /// The inputs have no such filter.
    pub(super) fn limits(&self, encoder_filter_ns: u32) -> Result<PinLimits, ParameterError> {
        let at = filter_for(self.filters, encoder_filter_ns);
        let Some(filter) = at.and_then(|at| self.filters.get(at)) else {
            return Err(ParameterError {
                name: "encoder_filter_ns",
                value: encoder_filter_ns as f32,
                max: self.filters.last().map_or(0.0, |filter| filter.stops_ns),
                given_by: "the longest filter of the inputs",
            });
        };
        Ok(PinLimits {
            largest_move_counts: f32::from(self.largest_move_counts),
            largest_counts_per_s: 1.5e9 / filter.passes_ns,
            longest_period_us: self.longest_period_us as f32,
        })
    }
}

/// The reading of one encoder.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EncoderReading {
    /// Counts of the hardware; wraps around.
    pub counts: EncoderCounts,
    /// Number of times that both channels changed at once, since power-up. A quadrature encoder never does that.
    pub illegal_transitions: u32,
}

/// The inputs of bench mode at the start of a period.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PinReadings {
    /// Motor encoder.
    pub motor: EncoderReading,
    /// Load encoder.
    pub load: EncoderReading,
    /// Fault of the power stage.
    pub stage_fault: Option<PowerStageFault>,
    /// Contacts at the inputs.
    pub contacts: Contacts,
    /// Mean torque since the last readings in N m, by the measured current; `None` if nothing measures it.
    pub torque_nm: Option<f32>,
    /// Mean voltage of the bridge in V, over the time of that torque; 0 if nothing measures it.
    pub bridge_voltage_v: f32,
}

/// Why the readings of the encoders allow no torque: the detail of the refusal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Implausible {
    /// The encoders were not read since power-up.
    Unread = 1,
    MotorTooFast = 2,
    LoadTooFast = 3,
    /// Both channels of the motor encoder changed at once.
    MotorChannels = 4,
    LoadChannels = 5,
}

impl From<Implausible> for Refusal {
    fn from(cause: Implausible) -> Self {
        Self { outcome: Outcome::EncoderImplausible, detail: cause as u32 }
    }
}

/// One encoder since power-up or reset.
#[derive(Clone, Copy, Default)]
struct Observed {
    illegal_at_reset: u32,
    /// Largest speed in counts per second. One count of each difference is subtracted, as in the check of a run.
    fastest_counts_per_s: f32,
}

/// Whether a host waits for the home switch or an index pulse.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Home {
    NotAwaited,
    /// The switch has to be seen open first. An index pulse that comes with the first readings may be older than the request.
    Awaited {
        was_active: bool,
    },
}

/// The pins since power-up or reset: a history that arming requires to be plausible.
pub(super) struct Pins {
    hardware: PinHardware,
    /// The latest readings and their due time.
    latest: Option<(PinReadings, Duration)>,
    motor: Observed,
    load: Observed,
    /// Where motor and load have rested since one of them last moved.
    place: [EncoderCounts; 2],
    /// When one of them last moved, if ever.
    moved_at: Option<Duration>,
    /// Counts of the hardware at the zero of motor and load.
    zero: [EncoderCounts; 2],
    home: Home,
}

impl Pins {
    pub(super) fn new(hardware: PinHardware) -> Self {
        Self {
            hardware,
            latest: None,
            motor: Observed::default(),
            load: Observed::default(),
            place: [EncoderCounts::default(); 2],
            moved_at: None,
            zero: [EncoderCounts::default(); 2],
            home: Home::NotAwaited,
        }
    }

    pub(super) fn hardware(&self) -> &PinHardware {
        &self.hardware
    }

    /// Forgets what was implausible before the latest readings. These stay: the ticks go on, and `Arm` may follow at once.
    pub(super) fn reset(&mut self) {
        let readings = self.readings();
        for (observed, reading) in [(&mut self.motor, readings.motor), (&mut self.load, readings.load)] {
            observed.illegal_at_reset = reading.illegal_transitions;
            observed.fastest_counts_per_s = 0.0;
        }
    }

    /// Counts of the hardware at the zero of motor and load.
    pub(super) fn zero(&self) -> [EncoderCounts; 2] {
        self.zero
    }

    /// Motor and load are at their zero.
    ///
    /// # Errors
    /// [`Outcome::EncoderImplausible`] before the first readings.
    pub(super) fn set_zero(&mut self) -> Result<(), Refusal> {
        let Some((readings, _)) = &self.latest else { return Err(Implausible::Unread.into()) };
        self.zero = [readings.motor.counts, readings.load.counts];
        self.home = Home::NotAwaited;
        Ok(())
    }

    /// The zero is where the home switch next closes, or at the next index pulse.
    pub(super) fn await_home(&mut self) {
        self.home = Home::Awaited { was_active: true };
    }

    pub(super) fn awaits_home(&self) -> bool {
        self.home != Home::NotAwaited
    }

    /// Takes the home switch of the latest readings.
    pub(super) fn note_home(&mut self, is_active: bool) {
        match &mut self.home {
            Home::Awaited { was_active: false } if is_active => {
                // There are readings.
                let _ = self.set_zero();
            }
            Home::Awaited { was_active } => *was_active = is_active,
            Home::NotAwaited => {}
        }
    }

    /// The zero of an encoder, 0 for the motor, is at these counts of its index pulse, which has come since the last call, if it
    /// counts. That of the other one is where it is at the latest readings.
    pub(super) fn note_index(&mut self, side: usize, index: Option<EncoderCounts>, counts: bool) {
        let Home::Awaited { was_active } = &mut self.home else { return };
        let is_first = core::mem::replace(was_active, false);
        if !is_first
            && counts
            && let Some(index) = index
            && self.set_zero().is_ok()
            && let Some(zero) = self.zero.get_mut(side)
        {
            *zero = index;
        }
    }

    /// The latest readings; zeros before the first ones.
    pub(super) fn readings(&self) -> PinReadings {
        self.latest.map(|(readings, _)| readings).unwrap_or_default()
    }

    /// Takes the readings of a period.
    pub(super) fn note(&mut self, readings: &PinReadings, due: Duration) {
        let place = [readings.motor.counts, readings.load.counts];
        if let Some((before, then)) = self.latest {
            let elapsed = due.saturating_sub(then);
            self.motor.note(before.motor, readings.motor, elapsed);
            self.load.note(before.load, readings.load, elapsed);
            let moved = |axis: usize| place[axis].wrapping_sub(self.place[axis]).unsigned_abs() > REST_COUNTS;
            if moved(0) || moved(1) {
                self.place = place;
                self.moved_at = Some(due);
            }
        } else {
            self.place = place;
        }
        self.latest = Some((*readings, due));
    }

    /// Whether motor and load have rested for a while.
    pub(super) fn rested(&self, now: Duration) -> bool {
        self.moved_at.is_none_or(|then| now.saturating_sub(then) >= REST)
    }

    /// Whether the pins allow torque.
    ///
    /// # Errors
    /// [`Outcome::PowerStageFault`] or [`Outcome::EncoderImplausible`], with the cause.
    pub(super) fn check(&self, drive: &DriveParameters) -> Result<(), Refusal> {
        let Some((readings, _)) = self.latest else { return Err(Implausible::Unread.into()) };
        if let Some(fault) = readings.stage_fault {
            return Err(Refusal { outcome: Outcome::PowerStageFault, detail: fault as u32 });
        }
        if readings.motor.illegal_transitions != self.motor.illegal_at_reset {
            return Err(Implausible::MotorChannels.into());
        }
        if readings.load.illegal_transitions != self.load.illegal_at_reset {
            return Err(Implausible::LoadChannels.into());
        }
        if self.motor.is_too_fast(drive.motor_counts_per_rev, drive.motor_speed_limit_rad_s) {
            return Err(Implausible::MotorTooFast.into());
        }
        if self.load.is_too_fast(drive.load_counts_per_rev, drive.load_speed_limit_rad_s) {
            return Err(Implausible::LoadTooFast.into());
        }
        Ok(())
    }
}

impl Observed {
    fn note(&mut self, before: EncoderReading, now: EncoderReading, elapsed: Duration) {
        let moved = now.counts.wrapping_sub(before.counts).unsigned_abs().saturating_sub(1);
        // Over a second or more no speed is implausible.
        if moved == 0 || elapsed.as_secs() > 0 || elapsed.is_zero() {
            return;
        }
        let speed = moved as f32 / (elapsed.subsec_nanos() as f32 * 1e-9);
        if speed > self.fastest_counts_per_s {
            self.fastest_counts_per_s = speed;
        }
    }

    fn is_too_fast(&self, counts_per_rev: u32, limit_rad_s: f32) -> bool {
        let fastest_rad_s = self.fastest_counts_per_s * (TAU / counts_per_rev as f32);
        fastest_rad_s > limit_rad_s * (1.0 + ROUNDING)
    }
}
