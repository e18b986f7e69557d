//! The drive in this process with encoders, a power stage and a plant: bench mode without a chip.
//!
//! Device time is virtual: it stands still while the bench computes, and advances from tick to tick while the bench waits.
//! The drive samples at its tick without jitter, and the torque acts at once. So a run shows drive and bench; timers, PWM and
//! edges are those of virtual silicon.

use std::f64::consts::TAU;
use std::io;
use std::time::{Duration, Instant};

use lashloop_firmware::actuator::StageCommand;
use lashloop_firmware::drive::{Clock, Drive, EncoderReading, PinHardware, PinReadings};
use lashloop_firmware::input_filter::FILTERS;
use lashloop_firmware::law::LawSet;
use lashloop_firmware::power_stage::StageMode;
use lashloop_link::in_process::{BOARD, Unread, next_tick};
use lashloop_link::{Link, LinkError, TimeBase};
use lashloop_plant::{Plant, PlantError};
use lashloop_protocol::EncoderCounts;

use super::error::DeviceError;
use super::pin_plant::PinPlant;
use crate::scenario::sections::EncoderSettings;

/// Limits of the encoder counters, 16 bits and a filter as on a board, and a servo amplifier.
const HARDWARE: PinHardware = PinHardware {
    largest_move_counts: i16::MAX as u16,
    filters: &FILTERS,
    stage_modes: &[StageMode::Amplifier],
    longest_period_us: 100_000,
    measures_current: false,
    has_index: [false; 2],
};
/// Longest step of the plant, the period of a PWM of 20 kHz.
const PLANT_STEP: Duration = Duration::from_micros(50);

struct DeviceTime(Duration);

impl Clock for DeviceTime {
    fn now(&self) -> Duration {
        self.0
    }
}

/// Plant, encoders and amplifier.
struct DriveTrain {
    plant: Box<dyn Plant>,
    /// Device time of the plant.
    at: Duration,
    torque_per_duty_nm: f64,
    torque_nm: f64,
    /// Counts per rad of motor and load.
    counts_per_rad: [f64; 2],
    /// Counts at power-up.
    zero: [i64; 2],
}

impl DriveTrain {
    fn counts(&self) -> [i64; 2] {
        let positions = self.plant.positions();
        let [motor, load] = self.counts_per_rad;
        [positions.motor_position_rad * motor, positions.load_position_rad * load]
            .map(|counts| counts.floor() as i64)
    }

    fn readings(&self) -> PinReadings {
        let counts = self.counts();
        let [motor, load] = std::array::from_fn(|side| EncoderReading {
            counts: EncoderCounts::wrapping(counts[side].wrapping_sub(self.zero[side])),
            illegal_transitions: 0,
        });
        PinReadings { motor, load, ..PinReadings::default() }
    }

    /// Takes the duty of the power stage. One that is off leaves the motor without torque.
    fn follow(&mut self, command: StageCommand<'_>) {
        self.torque_nm = match command {
            StageCommand::Off => 0.0,
            StageCommand::Torque { torque_nm, speed_rad_s, modulation } => {
                let [duty, _] = modulation.channels(torque_nm, speed_rad_s);
                (f64::from(duty) - 0.5) * self.torque_per_duty_nm
            }
        };
    }

    fn advance(&mut self, to: Duration) -> Result<(), PlantError> {
        while self.at < to {
            let step = PLANT_STEP.min(to - self.at);
            self.plant.step(self.torque_nm, step.as_secs_f64())?;
            self.at += step;
        }
        Ok(())
    }
}

/// A link to a drive with these laws, encoders, a power stage and a plant in this process.
pub(super) struct InProcessBench<L: LawSet> {
    drive: Drive<L>,
    train: DriveTrain,
    /// The instant at device time zero.
    boot: Instant,
    now: DeviceTime,
    next_sample: Duration,
    from_drive: Unread,
}

impl<L: LawSet> InProcessBench<L> {
    /// The drive with this plant, as the device of this name.
    ///
    /// # Errors
    /// The scenario lacks the scale of the amplifier, or a value of the plant is outside its range.
    pub(super) fn new(pins: &PinPlant, device: &str) -> Result<Self, DeviceError> {
        let EncoderSettings { motor_counts_per_rev, load_counts_per_rev, .. } = pins.scenario.encoders;
        let mut train = DriveTrain {
            torque_per_duty_nm: pins.torque_per_duty_nm(device)?,
            plant: pins.release(device)?,
            at: Duration::ZERO,
            torque_nm: 0.0,
            counts_per_rad: [motor_counts_per_rev, load_counts_per_rev].map(|counts| f64::from(counts) / TAU),
            zero: [0; 2],
        };
        train.zero = train.counts();
        Ok(Self {
            drive: Drive::with_pins(BOARD, HARDWARE),
            train,
            boot: Instant::now(),
            now: DeviceTime(Duration::ZERO),
            next_sample: Duration::ZERO,
            from_drive: Unread::default(),
        })
    }

    fn take_output(&mut self) {
        self.from_drive.take(&mut self.drive);
        self.train.follow(self.drive.stage_command());
    }

    /// Lets time pass until the drive's next tick, `until` at most.
    fn advance(&mut self, until: Instant) -> Result<(), LinkError> {
        let now = self.now.0;
        let until = until.saturating_duration_since(self.boot);
        let watchdog = next_tick(&self.drive, now);
        let next = watchdog.map_or(until, |due| due.min(until)).min(self.next_sample).max(now);
        let advanced = self.train.advance(next);
        advanced.map_err(|error| LinkError::Io(io::Error::other(error.to_string())))?;
        self.now.0 = next;
        self.drive.tick(next);
        if self.next_sample <= next {
            self.drive.sample(&self.train.readings(), next, &self.now);
            self.next_sample = next + self.drive.period();
        }
        self.take_output();
        Ok(())
    }
}

impl<L: LawSet> Link for InProcessBench<L> {
    fn inner(&mut self) -> Option<&mut dyn Link> {
        None
    }

    fn now(&mut self) -> Instant {
        self.boot + self.now.0
    }

    fn wait_until(&mut self, until: Instant) -> Result<(), LinkError> {
        while self.now() < until {
            self.advance(until)?;
        }
        Ok(())
    }

    /// Time is virtual always: the caller's ticks can't come by the wall clock.
    fn set_time_base(&mut self, _: TimeBase) {}

    fn send(&mut self, mut bytes: &[u8]) -> Result<(), LinkError> {
        // Arming needs readings, and a new period begins with a tick, so a request takes one; a reference takes none.
        if self.drive.stage_command() == StageCommand::Off {
            let until = self.boot + self.next_sample;
            self.advance(until)?;
        }
        while !bytes.is_empty() {
            let used = self.drive.receive(bytes, &self.now);
            bytes = &bytes[used..];
            self.take_output();
        }
        Ok(())
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
        while self.from_drive.is_empty() && self.now() < deadline {
            self.advance(deadline)?;
        }
        Ok(self.from_drive.read(buffer))
    }

    fn discard_input(&mut self) -> Result<(), LinkError> {
        self.from_drive.clear();
        Ok(())
    }
}
