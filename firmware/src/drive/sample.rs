//! The control path: an encoder sample in, a torque out.

use core::time::Duration;

use lashloop_protocol::enums::{Outcome, State, TorqueFlags, TorqueStatus};
use lashloop_protocol::message::{EncoderSample, FaultReport, Telemetry, TorqueAnswer};

use super::control_loop::ControlLoop;
use super::{Clock, Drive};
use crate::control::ControlOutput;

/// Where a sample stands in the run.
enum Place {
    /// This many periods after the one before; the first one counts as one.
    Next(u32),
    /// The one before, again.
    Repeated(TorqueAnswer),
    /// Of another run.
    Stray,
}

impl Drive {
    pub(super) fn answer_sample(&mut self, sample: &EncoderSample, clock: &impl Clock) {
        let arrived = clock.now();
        // A sample that comes after the watchdog's time is too late, even if nobody called `tick` in between.
        let tripped = self.safety.check_watchdog(arrived).err();
        if let Some(fault) = tripped {
            self.disarm_with(fault);
        }
        match self.state() {
            State::Boot => self.conclude::<EncoderSample>(Outcome::WrongState),
            State::Idle | State::Armed | State::Faulted => {
                self.answer(sample.sequence, 0.0, TorqueFlags::empty(), arrived, clock);
            }
            State::Running => match self.place(sample.sequence) {
                Place::Next(periods) => self.step(sample, periods, arrived, clock),
                Place::Repeated(answer) => {
                    let flags = answer.status.flags | TorqueFlags::REPEATED;
                    self.output
                        .send(TorqueAnswer { status: TorqueStatus { flags, ..answer.status }, ..answer });
                }
                Place::Stray => self.conclude::<EncoderSample>(Outcome::OutOfSequence),
            },
        }
        if let Some(fault) = tripped {
            self.output.send(fault);
        }
    }

    fn place(&self, sequence: u16) -> Place {
        let longest_gap = self.control.as_ref().map_or(1, ControlLoop::longest_gap);
        match (self.safety.last_sequence(), self.last_answer) {
            (None, _) if sequence == 0 => Place::Next(1),
            (Some(last), Some(answer)) if sequence == last => Place::Repeated(answer),
            (Some(last), _) if (1..=longest_gap).contains(&sequence.wrapping_sub(last)) => {
                Place::Next(sequence.wrapping_sub(last).into())
            }
            _ => Place::Stray,
        }
    }

    fn step(&mut self, sample: &EncoderSample, periods: u32, arrived: Duration, clock: &impl Clock) {
        self.safety.note_sample(sample.sequence, arrived);
        let mut flags = TorqueFlags::empty();
        flags.set(TorqueFlags::GAP, periods > 1);
        match self.controlled_torque(sample, periods) {
            Ok((torque_nm, saturated, opinion)) => {
                flags.set(TorqueFlags::SATURATED, saturated);
                self.answer(sample.sequence, torque_nm, flags, arrived, clock);
                self.send_telemetry(sample.sequence, &opinion);
            }
            Err(fault) => {
                self.disarm_with(fault);
                self.answer(sample.sequence, 0.0, flags, arrived, clock);
                self.output.send(fault);
            }
        }
    }

    fn controlled_torque(
        &mut self,
        sample: &EncoderSample,
        periods: u32,
    ) -> Result<(f32, bool, ControlOutput<f32>), FaultReport> {
        self.safety.check_reference(sample.reference_rad)?;
        let applied_nm = self.safety.torque_nm();
        // Running without a controller can't be; if it ever is, the torque it would give is not a number.
        let Some(control) = &mut self.control else { return Err(self.safety.no_controller()) };
        let (motor_rad_s, load_rad_s) = control.speeds(sample, periods);
        self.safety.check_speeds(motor_rad_s, load_rad_s)?;
        let opinion = control.step(sample, periods, applied_nm);
        let (torque_nm, saturated) = self.safety.allow(opinion.torque_nm)?;
        Ok((torque_nm, saturated, opinion))
    }

    fn answer(
        &mut self,
        sequence: u16,
        torque_nm: f32,
        flags: TorqueFlags,
        arrived: Duration,
        clock: &impl Clock,
    ) {
        let status = TorqueStatus { state: self.state(), flags };
        let compute_tenths_us = tenths_us(clock.now().saturating_sub(arrived));
        let answer = TorqueAnswer { sequence, torque_nm, status, compute_tenths_us };
        self.last_answer = Some(answer);
        self.output.send(answer);
    }

    fn send_telemetry(&mut self, sequence: u16, opinion: &ControlOutput<f32>) {
        let every = self.parameters.telemetry_every;
        if every > 0 && u32::from(sequence).is_multiple_of(every) {
            self.output.send(Telemetry {
                sequence,
                dead_zone_estimate_rad: opinion.dead_zone_estimate_rad,
                disturbing_torque_nm: opinion.disturbing_torque_nm,
                load_error_rad: opinion.load_error_rad,
                motor_error_rad: opinion.motor_error_rad,
                elastic_error_nm: opinion.elastic_error_nm,
                requested_torque_nm: opinion.torque_nm,
            });
        }
    }
}

/// In 32-bit arithmetic: a microcontroller divides 64 bits in software.
fn tenths_us(time: Duration) -> u16 {
    if time.as_secs() > 0 { u16::MAX } else { u16::try_from(time.subsec_nanos() / 100).unwrap_or(u16::MAX) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn compute_time_stays_at_its_largest_value() {
        assert_eq!(tenths_us(Duration::from_nanos(5_730)), 57);
        assert_eq!(tenths_us(Duration::from_micros(6_553)), 65_530);
        assert_eq!(tenths_us(Duration::from_millis(7)), u16::MAX);
        assert_eq!(tenths_us(Duration::from_secs(3)), u16::MAX);
    }
}
