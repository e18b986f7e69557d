//! Encoder sample to requested torque: wraparound, sensing and control law.

use core::f32::consts::TAU;

use lashloop_protocol::EncoderCounts;
use lashloop_protocol::limits::MAX_SIGNALS;
use lashloop_protocol::message::EncoderSample;
use lashloop_protocol::sequence::LONGEST_GAP;

use super::parameters::Parameters;
use super::pins::PinLimits;
use crate::control::sensing::{EncoderConfig, Sample, Sensing, SensingConfig};
use crate::law::{DriveParameters, DriveSignals, LawSet, ParameterError, ROUNDING, Signals};

/// Largest move in counts, in either direction, that the difference of two readings shows without wraparound. One count is
/// reserved: an encoder may show one count more than it has turned.
const LARGEST_MOVE_COUNTS: f32 = (EncoderCounts::MAX.get() - 1) as f32;

/// What was applied to the motor since the last step.
#[derive(Clone, Copy)]
pub(super) struct Applied {
    /// Torque in N m.
    pub(super) torque_nm: f32,
    /// Mean voltage of the bridge in V; 0 if nothing measures it.
    pub(super) voltage_v: f32,
}

pub(super) struct ControlLoop<L: LawSet> {
    sensing: Sensing<f32>,
    law: L,
    /// Torque of the law at the last step in N m, before the limit.
    requested_torque_nm: f32,
    applied: Applied,
    /// Signals of the law at the last step; `None` before the first one.
    signals: Option<L::Signals>,
    /// Counters of motor and load: the readings without wraparound. `None` before the first sample.
    previous_counts: Option<(i32, i32)>,
    longest_gap: u16,
    motor_rad_s_per_count: f32,
    load_rad_s_per_count: f32,
}

impl<L: LawSet> ControlLoop<L> {
    /// Sensing and law before the first sample. `pins` has the limits of the hardware in bench mode.
    ///
    /// # Errors
    /// If the parameters, each in its range, don't go together.
    pub(super) fn new(parameters: &Parameters<L>, pins: Option<&PinLimits>) -> Result<Self, ParameterError> {
        let drive = parameters.drive();
        let sensing = Sensing::new(sensing_config(&drive))?;
        let law = L::new(parameters.law(), parameters.words(), &drive)?;
        let [motor_rad_s_per_count, load_rad_s_per_count] =
            [drive.motor_counts_per_rev, drive.load_counts_per_rev]
                .map(|counts| TAU / (counts as f32 * drive.period_s()));
        let largest_move = match pins {
            None => LARGEST_MOVE_COUNTS,
            Some(limits) => {
                let longest_us = limits.longest_period_us;
                ParameterError::at_most("period_us", drive.period_us as f32, longest_us, "the timer")?;
                limits.largest_move_counts * (1.0 + ROUNDING)
            }
        };
        let mut longest_gap = LONGEST_GAP;
        for (name, limit_rad_s, rad_s_per_count) in [
            ("motor_speed_limit_rad_s", drive.motor_speed_limit_rad_s, motor_rad_s_per_count),
            ("load_speed_limit_rad_s", drive.load_speed_limit_rad_s, load_rad_s_per_count),
        ] {
            let fastest_rad_s = largest_move * rad_s_per_count;
            let given_by = "half the range of a reading over the control period";
            ParameterError::at_most(name, limit_rad_s, fastest_rad_s, given_by)?;
            if let Some(limits) = pins {
                let counts = limits.largest_counts_per_s * drive.period_s() * (1.0 + ROUNDING);
                let given_by = "the filter of the encoder inputs";
                ParameterError::at_most(name, limit_rad_s, counts * rad_s_per_count, given_by)?;
            }
            longest_gap = longest_gap.min((fastest_rad_s / limit_rad_s) as u16);
        }
        Ok(Self {
            sensing,
            law,
            requested_torque_nm: 0.0,
            applied: Applied { torque_nm: 0.0, voltage_v: 0.0 },
            signals: None,
            previous_counts: None,
            longest_gap,
            motor_rad_s_per_count,
            load_rad_s_per_count,
        })
    }

    /// Takes the value of a live parameter, in force from the next step.
    ///
    /// # Errors
    /// If it doesn't go with the others; then nothing changed.
    pub(super) fn update(&mut self, words: &L::Words) -> Result<(), ParameterError> {
        self.law.update(words)
    }

    /// Most periods between two samples of a run.
    pub(super) fn longest_gap(&self) -> u16 {
        self.longest_gap
    }

    /// Least speeds of motor and load since the last sample, in rad/s, in either direction; zero at the first sample. One count
    /// is subtracted, because an encoder at the border of two counts may show one without a motion.
    pub(super) fn speeds(&self, sample: &EncoderSample, periods: u32) -> (f32, f32) {
        let Some((motor, load)) = self.previous_counts else { return (0.0, 0.0) };
        let speed = |reading, counter, scale: f32| {
            moved(reading, counter).unsigned_abs().saturating_sub(1) as f32 * scale / periods as f32
        };
        (
            speed(sample.motor_counts, motor, self.motor_rad_s_per_count),
            speed(sample.load_counts, load, self.load_rad_s_per_count),
        )
    }

    /// One control step: the torque in N m, before the limit.
    pub(super) fn step(&mut self, sample: &EncoderSample, periods: u32, applied: Applied) -> f32 {
        let (motor_counts, load_counts) = match self.previous_counts {
            None => (sample.motor_counts.get(), sample.load_counts.get()),
            Some((motor, load)) => (
                motor.wrapping_add(moved(sample.motor_counts, motor)),
                load.wrapping_add(moved(sample.load_counts, load)),
            ),
        };
        self.previous_counts = Some((motor_counts, load_counts));
        let measurement = self.sensing.step(&Sample {
            motor_counts,
            load_counts,
            reference_rad: sample.reference_rad,
            applied_torque_nm: applied.torque_nm,
            elapsed_periods: periods,
        });
        self.applied = applied;
        self.requested_torque_nm = self.law.step(&measurement, &mut self.signals);
        self.requested_torque_nm
    }

    /// Counts of motor and load at the last step, without wraparound; zeros before the first one.
    pub(super) fn counts(&self) -> [i32; 2] {
        self.previous_counts.map_or([0; 2], |(motor, load)| [motor, load])
    }

    /// Whether the reference is a torque.
    pub(super) fn takes_torque(&self) -> bool {
        self.law.takes_torque()
    }

    /// Speed of the motor at the last step in rad/s.
    pub(super) fn motor_speed_rad_s(&self) -> f32 {
        self.sensing.motion().motor_velocity_rad_s
    }

    /// Twist of the last step in rad at the motor.
    pub(super) fn twist_rad(&self) -> f32 {
        self.sensing.motion().twist_rad
    }

    /// The values of all signals at the last step, by their indices; zero for a signal of another law.
    pub(super) fn signals(&self) -> [f32; MAX_SIGNALS] {
        let motion = self.sensing.motion();
        let of_drive = DriveSignals {
            requested_torque_nm: self.requested_torque_nm,
            measured_motor_velocity_rad_s: motion.motor_velocity_rad_s,
            measured_load_velocity_rad_s: motion.load_velocity_rad_s,
            measured_twist_rad: motion.twist_rad,
            measured_torque_nm: self.applied.torque_nm,
            bridge_voltage_v: self.applied.voltage_v,
        };
        let mut values = [0.0; MAX_SIGNALS];
        of_drive.write(&mut values);
        if let Some(of_law) = &self.signals {
            L::write_signals(of_law, &mut values);
        }
        values
    }
}

fn sensing_config(drive: &DriveParameters) -> SensingConfig<f32> {
    let encoder = |counts_per_revolution, velocity_bandwidth_rad_s| EncoderConfig {
        counts_per_revolution,
        velocity_bandwidth_rad_s,
    };
    SensingConfig {
        motor: encoder(drive.motor_counts_per_rev, drive.motor_filter_rad_s),
        load: encoder(drive.load_counts_per_rev, drive.load_filter_rad_s),
        ratio: drive.reduction_ratio,
        period_s: drive.period_s(),
    }
}

/// Counts from a counter to a reading.
fn moved(reading: EncoderCounts, counter: i32) -> i32 {
    reading.wrapping_sub(EncoderCounts::wrapping(counter.into()))
}
